//! Section 1: the answer in one paragraph.

use super::Answer;
use super::numbers::{NINETY_FIVE, percent, plain};
use crate::verdict::Standing;
use minijinja::context;
use poinsot_report::{PageError, Part, render, significant};

pub(super) fn part(answer: &Answer) -> Result<Part, PageError> {
    let e = &answer.estimate;
    let standing = standing(answer);
    let (tone, word) = standing.badge();
    let samples: usize = e.fit.iter().map(|f| f.samples).sum();
    let span: f64 = {
        let mut spans = std::collections::BTreeMap::new();
        for input in &e.inputs {
            let longest: &mut f64 = spans.entry(input.segment).or_default();
            *longest = longest.max(input.time_s[1] - input.time_s[0]);
        }
        spans.values().sum()
    };
    let body = render(
        "verdict.html",
        include_str!("templates/verdict.html"),
        context! {
            tone, word,
            withheld => e.is_withheld(),
            sentences => sentences(answer),
            combinations => format!("{} of {}", e.identifiability.rank, e.identifiability.parameters),
            samples,
            segments => e.fit.len(),
            span => plain((span * 10.0).round() / 10.0),
            chi2 => significant(standing.chi2, 3),
            uncertainty_tone => standing.uncertainty().0,
            uncertainty => standing.uncertainty().1,
            warnings => e.warnings.len(),
        },
    )?;
    Ok(Part {
        id: "verdict",
        title: "Verdict",
        body,
        figures: Vec::new(),
    })
}

fn standing(answer: &Answer) -> Standing<'_> {
    let e = &answer.estimate;
    let chi2 = e.fit.iter().filter_map(|f| f.chi2_per_dof);
    Standing {
        status: &e.status,
        covariance_trustworthy: e.covariance_trustworthy,
        doubts: &e.doubts,
        chi2: chi2.fold(0.0, f64::max),
    }
}

fn sentences(answer: &Answer) -> Vec<String> {
    let e = &answer.estimate;
    let i = &e.identifiability;
    let mut out = vec![match e.status.as_str() {
        "converged" => "Every number that was asked for is determined by these data.".to_owned(),
        "partial" => format!(
            "Only part of what was asked for is determined: {} of {} independent combinations. \
             What these data cannot tell is marked \"not identifiable\" below, with the reason and a remedy.",
            i.rank, i.parameters
        ),
        "not_identifiable" => {
            "Nothing that was asked for is determined by these data; section 4 says why.".to_owned()
        }
        "rejected" => {
            let found: Vec<String> = e
                .warnings
                .iter()
                .take(2)
                .map(|w| format!("{}.", sentence(w)))
                .collect();
            format!(
                "The rigid model contradicts the data, and its numbers are withheld. {} Section 7 has all that was found.",
                found.join(" ")
            )
        }
        "iteration_limit" => "The iteration did not settle: no number is given.".to_owned(),
        other => format!("Status {other}."),
    }];
    if let Some(open) = i.not_identifiable.first().filter(|_| e.status == "partial") {
        out.push(format!(
            "Why: {}. To change that: {}.",
            sentence(&open.reason),
            sentence(&open.remedy)
        ));
    }
    if let Some((name, share)) = worst(answer) {
        out.push(format!(
            "The least certain of them is {name}, known to {} % of its body's natural scale (95 %).",
            significant(100.0 * share, 2)
        ));
    }
    if let Some(farthest) = farthest(answer) {
        out.push(farthest);
    }
    if !e.is_withheld() {
        out.push(standing(answer).reliance());
    }
    if answer.truth.is_known() {
        out.push(within(answer));
    }
    out
}

/// The number with the widest interval relative to the scale of its kind.
fn worst(answer: &Answer) -> Option<(String, f64)> {
    let bodies = &answer.estimate.bodies;
    let mut worst: Option<(String, f64)> = None;
    for (name, body) in bodies.iter().filter(|b| b.1.is_asked()) {
        let numbers = body.numbers();
        let inertia = numbers[4..]
            .iter()
            .map(|n| n.2.nominal.abs().max(n.2.value.map_or(0.0, f64::abs)));
        let largest = inertia.fold(0.0, f64::max);
        let mass = body.mass_kg.value.unwrap_or(body.mass_kg.nominal).abs();
        let gyration = (1.5 * largest / mass.max(f64::MIN_POSITIVE)).sqrt();
        for (k, (what, _, n)) in numbers.iter().enumerate().filter(|(_, n)| !n.2.is_known()) {
            let scale = match k {
                0 => mass,
                1..=3 => gyration,
                _ => largest,
            };
            if let (Some(sigma), true) = (n.sigma, scale > 0.0) {
                let share = NINETY_FIVE * sigma / scale;
                if worst.as_ref().is_none_or(|w| share > w.1) {
                    worst = Some((format!("{name} {what}"), share));
                }
            }
        }
    }
    worst
}

/// A clause without its full stop.
fn sentence(text: &str) -> &str {
    text.trim().trim_end_matches('.')
}

fn farthest(answer: &Answer) -> Option<String> {
    let bodies = &answer.estimate.bodies;
    let all = bodies.iter().flat_map(|(name, body)| {
        let numbers = body.numbers();
        numbers.into_iter().filter_map(move |(what, _, n)| {
            let gap = n.value? - n.nominal;
            let z = gap / n.sigma.filter(|s| *s > 0.0)?;
            Some((format!("{name} {what}"), z.abs(), percent(gap, n.nominal)))
        })
    });
    let (name, z, share) = all
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|w| w.1 > NINETY_FIVE)?;
    let z = if z < 1000.0 {
        significant(z, 3)
    } else {
        format!("{z:.0}")
    };
    Some(if share.is_empty() {
        format!("Farthest from its nominal value is {name}, by {z} sigma.")
    } else {
        format!("Farthest from its nominal value is {name}, by {share} or {z} sigma.")
    })
}

/// How many intervals hold the truth.
fn within(answer: &Answer) -> String {
    let (mut inside, mut judged) = (0, 0);
    for (name, body) in &answer.estimate.bodies {
        let truth = answer.truth.body(name);
        for ((_, _, n), true_value) in body.numbers().iter().zip(truth) {
            if let (Some(v), Some(s), Some(t)) = (n.value, n.sigma, true_value)
                && s > 0.0
            {
                judged += 1;
                inside += usize::from((v - t).abs() <= NINETY_FIVE * s);
            }
        }
    }
    if judged == 0 {
        return "The truth of the simulation is known and shown beside the numbers.".to_owned();
    }
    format!(
        "The truth of the simulation is known: {inside} of {judged} 95 % intervals hold it (errors of one run are correlated; coverage is a matter of many runs)."
    )
}
