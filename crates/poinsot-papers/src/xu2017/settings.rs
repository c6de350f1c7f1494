//! Settings of the swarm; the paper prints none.

use super::Kind;
use super::sequence::Solver;
use crate::setting::{SettingText, Settings, refused};
use poinsot_files::Faults;

/// Largest number of particles or iterations; a larger value is a typing error.
const MOST: u32 = 10_000_000;

/// Settings for `--set`.
pub(super) const SETTINGS: &[SettingText] = &[
    SettingText::new("particles", "particles of the swarm", "50"),
    SettingText::new("iterations", "most iterations", "4000"),
    SettingText::new(
        "patience",
        "iterations without a better best after which the swarm stops",
        "400",
    ),
    SettingText::new(
        "inertia",
        "weight of the old velocity: one number, or the first and last of a linear change, first,last",
        "0.8,0.6",
    ),
    SettingText::new("c1", "pull towards the particle's own best", "1.49445"),
    SettingText::new("c2", "pull towards the best of all", "1.49445"),
    SettingText::new(
        "range",
        "half-width of the search range as a share of nominal mass, moments and radius of gyration",
        "0.5",
    ),
    SettingText::new("seed", "seed of the swarm", "0"),
];

/// Solver of a variant with its settings.
pub(super) fn solver(kind: Kind, settings: &Settings) -> Result<Solver, Faults> {
    let mut solver = Solver {
        kind,
        ..Solver::default()
    };
    let swarm = &mut solver.swarm;
    for (key, value) in [
        ("particles", &mut swarm.particles),
        ("iterations", &mut swarm.iterations),
        ("patience", &mut swarm.patience),
    ] {
        let given = settings.count(key, 1, MOST)?;
        *value = given.map_or(*value, |n| n as usize);
    }
    let [c1, c2] = &mut swarm.attraction;
    for (key, least, most, value) in [
        ("c1", 0.0, 10.0, c1),
        ("c2", 0.0, 10.0, c2),
        ("range", 1.0e-6, 1.0e6, &mut solver.share),
    ] {
        *value = settings.number(key, least, most)?.unwrap_or(*value);
    }
    let seed = settings.count("seed", 0, u32::MAX)?;
    swarm.seed = seed.map_or(swarm.seed, u64::from);
    if let Some(text) = settings.text("inertia") {
        swarm.weight = inertia(text)?;
    }
    Ok(solver)
}

/// One weight, or the first and the last.
fn inertia(text: &str) -> Result<[f64; 2], Faults> {
    let number = |t: &str| t.trim().parse().ok().filter(|w| (0.0..=2.0).contains(w));
    let (first, last) = text.split_once(',').unwrap_or((text, text));
    let pair = number(first).zip(number(last));
    pair.map(|(first, last)| [first, last]).ok_or_else(|| {
        let advice = "give one number from 0 to 2, or two with a comma";
        refused("inertia", text, "it is out of range", advice)
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::xu2017::swarm::Swarm;

    #[test]
    fn unit_defaults_in_words_are_those_of_the_solver() {
        let texts: Vec<String> = SETTINGS
            .iter()
            .map(|s| format!("{}={}", s.key, s.default))
            .collect();
        let set = solver(Kind::Swarm, &Settings::parse(&texts).unwrap()).unwrap();
        let usual = solver(Kind::Swarm, &Settings::default()).unwrap();
        assert_eq!(set, usual);
        assert_eq!(
            (usual.swarm, usual.share),
            (Swarm::default(), Solver::default().share)
        );
    }

    #[test]
    fn unit_every_setting_reaches_the_solver() {
        let usual = solver(Kind::Swarm, &Settings::default()).unwrap();
        for (setting, value) in SETTINGS
            .iter()
            .zip(["7", "9", "11", "0.5", "1", "2", "3", "4"])
        {
            let text = format!("{}={value}", setting.key);
            let set = solver(Kind::Swarm, &Settings::parse(&[&text]).unwrap()).unwrap();
            assert_ne!(set, usual, "{text}");
        }
        for bad in ["inertia=3", "inertia=a", "c1=-1", "range=0", "particles=0"] {
            let why = solver(Kind::Swarm, &Settings::parse(&[bad]).unwrap());
            assert!(why.unwrap_err().to_string().contains(bad), "{bad}");
        }
    }
}
