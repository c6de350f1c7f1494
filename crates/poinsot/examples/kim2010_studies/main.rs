//! Tables 2 and 3 and figures 1 to 4 of Kim, Choi and Oh 2010, and what became of them.
//!
//!     cargo run --release -p poinsot --example kim2010_studies -- STUDY [OUT_DIR]
#![allow(non_snake_case, missing_docs)]

mod figures;
mod inversion;
mod manoeuvres;
mod names;
mod printed;
mod slew;
mod svg;
mod trials;

use inversion::{Noise, invert};
use poinsot_papers::kim2010::{Kim2010Error, NAMES, Sums, VISITED};
use poinsot_spatial::{Matrix3, Vector3};
use slew::{RATE, Slew};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use trials::{COLUMNS, Columns, PRINTED, SIGMA, chi_square, columns, quantile};

type Failure = Box<dyn std::error::Error>;

/// Table 1, in the order of the tables.
const TRUE: [f64; 6] = [13.916, 16.954, 19.894, 0.085, 0.5896, 0.133];
/// Samples skipped for 10, 5, 2, 1 and 0.5 Hz.
const STEPS: [usize; 5] = [1, 2, 5, 10, 20];
/// `N sigma^2 / sum s^2` that stands for little noise.
const SMALL_RIDGE: f64 = 1.0e-5;
const LENGTHS: [usize; 7] = [60, 100, 200, 300, 350, 400, 600];

fn main() -> Result<(), Failure> {
    let mut words = std::env::args().skip(1);
    let study = words.next().unwrap_or_default();
    let out = PathBuf::from(words.next().unwrap_or_else(|| ".".to_owned()));
    if !names::STUDIES.iter().any(|s| s.0 == study) {
        let list = names::STUDIES.map(|(name, what, _)| format!("\n  {name:13} {what}"));
        return Err(format!("usage: kim2010_studies STUDY [OUT_DIR]{}", list.join("")).into());
    }
    std::fs::create_dir_all(&out)?;
    let slew = Slew::simulate()?;
    let asked = |name: &str| study == name || study == "all";
    if asked("axis") {
        axis(&slew);
    }
    if asked("table2") {
        noise_free(&slew, &out)?;
    }
    if asked("pre-estimate") {
        pre_estimate(&slew)?;
    }
    if asked("orders") {
        orders(&slew)?;
    }
    if asked("iteration") {
        iteration(&slew)?;
    }
    if asked("bands") {
        let bands = bands(&slew, &out)?;
        figures::draw(&slew, &bands, &out)?;
    }
    if asked("manoeuvres") {
        manoeuvres(&out)?;
    }
    Ok(())
}

/// The axis of the slew.
fn normal(slew: &Slew) -> Vector3 {
    slew.R_NB[0].axis().map_or(slew.w[0], |a| a.into_inner())
}

/// On one axis `Q = I n s`, so `sum Q_x w_y / sum Q_y w_y = (I n)_x / (I n)_y` whatever the noise of the
/// rates: the printed conventional products must follow from the printed moments.
fn products_from_moments(In: &[f64; 3]) {
    let m = &PRINTED[1];
    let product = |i: usize, j: usize| 0.5 * (m[j] * In[i] / In[j] + m[i] * In[j] / In[i]);
    println!(
        "\nconventional products from the printed moments and I n alone: {:.4} {:.4} {:.4}; printed {:.4} {:.4} {:.4}",
        product(0, 1),
        product(1, 2),
        product(2, 0),
        m[3],
        m[4],
        m[5]
    );
}

/// The direction of the rates, how far they leave it, and what follows for the conventional products.
fn axis(slew: &Slew) {
    let n = normal(slew);
    println!("axis of the slew n = {:.4}, {:.4}, {:.4}", n.x, n.y, n.z);
    let off = slew
        .w
        .iter()
        .map(|w| (w - n * w.dot(&n)).norm())
        .fold(0.0, f64::max);
    let along = slew.w.iter().map(|w| w.norm()).fold(0.0, f64::max);
    println!("largest rate {along:.4e} rad/s, across n {off:.1e} rad/s");
    products_from_moments(&(slew.I * n).into());
}

/// What each column is without noise.
fn noise_free(slew: &Slew, out: &Path) -> Result<(), Failure> {
    let found = columns(&slew.sums(350, 10, &[])?)?;
    let mut csv = "column,element,true,noise_free,printed\n".to_owned();
    println!(
        "\nTable 2 without noise      {}",
        NAMES.map(|n| format!("{n:>9}")).join("")
    );
    for (c, name) in COLUMNS.iter().enumerate() {
        println!("  {name:<14} noise-free {}", row(&found[c]));
        println!("  {:<14} printed    {}", "", row(&PRINTED[c]));
        for (k, element) in NAMES.iter().enumerate() {
            let (a, b, t) = (found[c][k], PRINTED[c][k], TRUE[k]);
            writeln!(csv, "{name},{element},{t},{a:.6},{b}")?;
        }
    }
    std::fs::write(out.join("table2_noise_free.csv"), csv)?;
    Ok(())
}

fn row(x: &[f64; 6]) -> String {
    x.map(|x| format!("{x:9.4}")).join("")
}

/// The column "Considering pre-estimate" from the sums that the other columns fix.
fn pre_estimate(slew: &Slew) -> Result<(), Failure> {
    let n = normal(slew);
    let fixed = invert(&n, &(slew.I * n), &PRINTED)?;
    println!(
        "\nsums fixed by 15 printed numbers (batch, conventional, suggested): worst difference {:.2} of half a digit",
        fixed.worst
    );
    let found = fixed.sums.pre_estimate()?.printed;
    println!(
        "  considering pre-estimate from them: {:.5} {:.5} {:.5}; printed {} {} {}",
        found[3], found[4], found[5], PRINTED[2][3], PRINTED[2][4], PRINTED[2][5]
    );
    // Integral of s^2: the slew is over long before the record.
    let squares: Vec<f64> = slew.w.iter().map(|w| w.dot(&n).powi(2)).collect();
    let integral = squares.iter().sum::<f64>() / RATE as f64;
    let noise = Noise::of(&fixed, &n);
    println!(
        "  noise across the axis: a record of {:.0} s at any rate; common shift of the rates against Q {:.2} %",
        noise.length(SIGMA, integral),
        100.0 * noise.along
    );
    println!("  rate Hz, chi-square of the scatter on 6, common shift in sigmas");
    for rate in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0] {
        let (scatter, along) = noise.at(rate, SIGMA, integral);
        println!("  {rate:4} {scatter:6.2} {along:6.2}");
    }
    let ordered = fixed.sums.pre_estimate_in_order(&VISITED)?.printed;
    println!(
        "  one after the other, column by column: {:.5} {:.5} {:.5}",
        ordered[3], ordered[4], ordered[5]
    );
    Ok(())
}

/// Answer, chi-square and order of one reading of the column.
type Tried = ([f64; 6], f64, [(usize, usize); 6]);

/// The sequential readings of "considering pre-estimate", in every order of the six products: chi-square of
/// its three printed products at 350 s and 1 Hz, on 3; the reading with all at once beside them.
fn orders(slew: &Slew) -> Result<(), Failure> {
    let all = trials::sums(slew, 10, &[350])?;
    let sums = all.first().ok_or("no trials")?;
    let one = sums.first().ok_or("no trials")?;
    let mut tried: Vec<Tried> = Vec::new();
    let mut count = 0;
    let mut order = VISITED;
    permutations(&mut order, 0, &mut |order| {
        count += 1;
        let first = one.pre_estimate_in_order(order)?.printed;
        let same = |x: &[f64; 6]| (0..6).all(|k| (x[k] - first[k]).abs() < 1e-9);
        if tried.iter().any(|t| same(&t.0)) {
            return Ok(());
        }
        let products = sums.iter().map(|s| {
            s.pre_estimate_in_order(order)
                .map(|a| a.printed[3..].to_vec())
        });
        let products = products.collect::<Result<Vec<_>, _>>()?;
        tried.push((first, chi_square(&products, &PRINTED[2][3..]), *order));
        Ok(())
    })?;
    tried.sort_by(|a, b| a.1.total_cmp(&b.1));
    println!(
        "\npre-estimate in {count} orders, {} different answers; smallest chi-square on 3:",
        tried.len()
    );
    for (_, chi2, order) in tried.iter().take(3) {
        println!("  {chi2:6.1}  {order:?}");
    }
    let at_once = sums
        .iter()
        .map(|s| s.pre_estimate().map(|a| a.printed[3..].to_vec()));
    let at_once = at_once.collect::<Result<Vec<_>, _>>()?;
    println!(
        "  {:6.1}  all at once",
        chi_square(&at_once, &PRINTED[2][3..])
    );
    Ok(())
}

type Visit<'v> = &'v mut dyn FnMut(&[(usize, usize); 6]) -> Result<(), Kim2010Error>;

fn permutations(
    order: &mut [(usize, usize); 6],
    from: usize,
    visit: Visit,
) -> Result<(), Kim2010Error> {
    if from == order.len() {
        return visit(order);
    }
    for k in from..order.len() {
        order.swap(from, k);
        permutations(order, from + 1, visit)?;
        order.swap(from, k);
    }
    Ok(())
}

/// The announced iteration on the paper's slew.
fn iteration(slew: &Slew) -> Result<(), Kim2010Error> {
    println!("\niteration of (14)-(16)");
    for seed in [None, Some(0), Some(1), Some(2)] {
        let noise = seed.map_or(Vec::new(), |s| trials::noise(s, 351));
        let it = slew.sums(350, 10, &noise)?.iterated()?;
        let kind = seed.map_or("noise-free".to_owned(), |s| format!("noise, seed {s}"));
        println!(
            "  {kind:<14} sweeps {:5}, spectral radius {:.6}, free directions {}, ends at {}",
            it.sweeps,
            it.spectral_radius,
            it.free_directions,
            row(&it.answer.printed)
        );
    }
    // The limit of little noise: a ridge that does not matter beside the motion.
    let n = normal(slew);
    let g = slew.I * n;
    let G = n * n.transpose() + Matrix3::identity() * SMALL_RIDGE;
    let limit = Sums::at_rest(G, g * n.transpose(), 350)?.iterated()?;
    println!(
        "  little noise: fixed point {}",
        limit.fixed_point.map_or("none".to_owned(), |x| row(&x))
    );
    let I = symmetric_fit(&n, &g);
    let six = poinsot_papers::kim2010::ELEMENTS.map(|e| I[e]);
    println!(
        "  symmetric least squares of six numbers, little noise: {}",
        row(&six)
    );
    Ok(())
}

/// The symmetric tensor of smallest Frobenius norm with `I n = g`: what least squares tends to as noise, which
/// adds `N sigma^2 |I|^2` to the sum of squares, goes to zero.
fn symmetric_fit(n: &Vector3, g: &Vector3) -> Matrix3 {
    g * n.transpose() + n * g.transpose() - n * n.transpose() * g.dot(n)
}

/// All trials of one rate and length.
pub struct Cell {
    pub step: usize,
    pub length: usize,
    pub trials: Vec<Columns>,
}

impl Cell {
    pub fn of(&self, column: usize, element: usize) -> Vec<f64> {
        self.trials.iter().map(|t| t[column][element]).collect()
    }
}

fn bands(slew: &Slew, out: &Path) -> Result<Vec<Cell>, Failure> {
    let mut cells = Vec::new();
    for step in STEPS {
        let by_length = trials::sums(slew, step, &LENGTHS)?;
        for (length, list) in LENGTHS.into_iter().zip(by_length) {
            let trials = list.iter().map(columns).collect::<Result<Vec<_>, _>>()?;
            cells.push(Cell {
                step,
                length,
                trials,
            });
        }
    }
    let mut csv = "rate_hz,length_s,column,element,median,p05,p95,printed,inside\n".to_owned();
    println!(
        "\n{} seeds, noise 1e-4 rad/s: printed numbers inside the 5-95 % band (batch, conventional, pre-estimate, suggested; of 6 each), chi-square of the suggested column on 6",
        trials::SEEDS
    );
    for cell in &cells {
        let rate = RATE as f64 / cell.step as f64;
        let mut inside = [0; 4];
        for (c, column) in COLUMNS.iter().enumerate() {
            for (k, element) in NAMES.iter().enumerate() {
                let values = cell.of(c, k);
                let q = [0.5, 0.05, 0.95].map(|p| quantile(&values, p));
                let is_in = q[1] <= PRINTED[c][k] && PRINTED[c][k] <= q[2];
                inside[c] += usize::from(is_in);
                let (length, printed) = (cell.length, PRINTED[c][k]);
                writeln!(
                    csv,
                    "{rate},{length},{column},{element},{:.4},{:.4},{:.4},{printed},{is_in}",
                    q[0], q[1], q[2]
                )?;
            }
        }
        let suggested: Vec<Vec<f64>> = cell.trials.iter().map(|t| t[3].to_vec()).collect();
        let chi2 = chi_square(&suggested, &PRINTED[3]);
        println!(
            "  {rate:4} Hz {:4} s  inside {inside:?}  chi-square {chi2:8.1}",
            cell.length
        );
    }
    std::fs::write(out.join("table2_bands.csv"), csv)?;
    tables(&cells);
    Ok(cells)
}

/// Tables 2 and 3 at 350 s and 1 Hz.
fn tables(cells: &[Cell]) {
    for (step, rate) in [(10, "1 Hz"), (20, "0.5 Hz")] {
        let Some(cell) = cells.iter().find(|c| c.step == step && c.length == 350) else {
            continue;
        };
        println!(
            "\nTables 2 and 3 at 350 s, {rate}: median [5 %, 95 %], printed; error of the median, printed error"
        );
        for (c, column) in COLUMNS.iter().enumerate() {
            for (k, element) in NAMES.iter().enumerate() {
                let values = cell.of(c, k);
                let q = [0.5, 0.05, 0.95].map(|p| quantile(&values, p));
                let error = |x: f64| 100.0 * (x - TRUE[k]).abs() / TRUE[k];
                let printed = PRINTED[c][k];
                let mark = if q[1] <= printed && printed <= q[2] {
                    "inside"
                } else {
                    "OUTSIDE"
                };
                println!(
                    "  {column:<13} {element} {:9.4} [{:9.4}, {:9.4}]  {printed:9.4} {mark:<8} {:10.2} % {:10.2} %",
                    q[0],
                    q[1],
                    q[2],
                    error(q[0]),
                    error(printed)
                );
            }
        }
    }
}

/// One slew and three slews of two sizes: every column and maximum likelihood, noise-free and noisy.
fn manoeuvres(out: &Path) -> Result<(), Failure> {
    let mut csv = "slews,method,noise,element,true,mean,rms_error,stated_sigma,rms_error_percent\n"
        .to_owned();
    for (name, case) in manoeuvres::CASES {
        let list = manoeuvres::answers(case)?;
        println!(
            "\n{name}: mean answer, kg m2; rms error, percent of each element; stated sigma, percent"
        );
        println!("  {:<30}{}", "", NAMES.map(|n| format!("{n:>12}")).join(""));
        println!(
            "  {:<30}{}",
            "true",
            TRUE.map(|t| format!("{t:12.4}")).join("")
        );
        let percent = |x: &[f64; 6]| -> String {
            let each = (0..6).map(|k| format!("{:12.2e}", 100.0 * x[k] / TRUE[k]));
            each.collect()
        };
        for answer in &list {
            let kind = if answer.noisy { "" } else { ", no noise" };
            let title = format!("{}{kind}", answer.name);
            if answer.mean.iter().any(|x| x.is_nan()) {
                println!("  {title:<30}withheld: not identifiable");
                continue;
            }
            println!(
                "  {title:<30}{}",
                answer.mean.map(|x| format!("{x:12.4}")).join("")
            );
            println!("  {:<30}{}", "    error %", percent(&answer.rms));
            if let Some(sigma) = answer.sigma {
                println!("  {:<30}{}", "    sigma %", percent(&sigma));
            }
            for (k, element) in NAMES.iter().enumerate() {
                let sigma = answer
                    .sigma
                    .map_or(String::new(), |s| format!("{:.3e}", s[k]));
                let (mean, rms, t) = (answer.mean[k], answer.rms[k], TRUE[k]);
                writeln!(
                    csv,
                    "{name},{},{},{element},{t},{mean:.6},{rms:.3e},{sigma},{:.3e}",
                    answer.name,
                    answer.noisy,
                    100.0 * rms / t
                )?;
            }
        }
        if case == manoeuvres::CASES[2].1 {
            std::fs::write(out.join("second_axis.svg"), figures::second_axis(&list))?;
        }
    }
    std::fs::write(out.join("second_axis.csv"), csv)?;
    Ok(())
}
