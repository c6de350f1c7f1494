//! Figures 1 to 4 and Tables 2 and 3 of Kim, Choi and Oh 2010, and what became of them.
//!
//!     cargo run --release -p poinsot --example kim2010_studies -- OUT_DIR
#![allow(non_snake_case, missing_docs)]

mod figures;
mod second_axis;
mod slew;
mod svg;
mod trials;

use poinsot_papers::kim2010::{Kim2010Error, NAMES, VISITED};
use slew::{RATE, Slew};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use trials::{COLUMNS, Columns, PRINTED, chi_square, columns, quantile};

type Failure = Box<dyn std::error::Error>;

/// Table 1, in the order of the tables.
const TRUE: [f64; 6] = [13.916, 16.954, 19.894, 0.085, 0.5896, 0.133];
/// Samples skipped for 10, 5, 2, 1 and 0.5 Hz.
const STEPS: [usize; 5] = [1, 2, 5, 10, 20];
const LENGTHS: [usize; 7] = [60, 100, 200, 300, 350, 400, 600];

fn main() -> Result<(), Failure> {
    let Some(out) = std::env::args().nth(1).map(PathBuf::from) else {
        return Err("usage: kim2010_studies OUT_DIR".into());
    };
    std::fs::create_dir_all(&out)?;
    let slew = Slew::simulate()?;
    noise_free(&slew, &out)?;
    iteration(&slew)?;
    orders(&slew)?;
    let bands = bands(&slew, &out)?;
    figures::draw(&slew, &bands, &out)?;
    second_axis(&out)?;
    println!("written: {}", out.display());
    Ok(())
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

/// What each column is without noise.
fn noise_free(slew: &Slew, out: &Path) -> Result<(), Failure> {
    let n = slew.R_NB[0].axis().map_or(slew.w[0], |a| a.into_inner());
    println!("axis of the slew n = {:.4}, {:.4}, {:.4}", n.x, n.y, n.z);
    let off = slew
        .w
        .iter()
        .map(|w| (w - n * w.dot(&n)).norm())
        .fold(0.0, f64::max);
    let along = slew.w.iter().map(|w| w.norm()).fold(0.0, f64::max);
    println!("largest rate {along:.4e} rad/s, across n {off:.1e} rad/s");
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
    products_from_moments(&(slew.I * n).into());
    Ok(())
}

fn row(x: &[f64; 6]) -> String {
    x.map(|x| format!("{x:9.4}")).join("")
}

/// Answer, chi-square and order of one reading of the column.
type Tried = ([f64; 6], f64, [(usize, usize); 6]);

/// The column "Considering pre-estimate" in every order in which the six products can be found: chi-square
/// of its three printed products at 350 s and 1 Hz, on 3.
fn orders(slew: &Slew) -> Result<(), Failure> {
    let all = trials::sums(slew, 10, &[350])?;
    let sums = all.first().ok_or("no trials")?;
    let one = sums.first().ok_or("no trials")?;
    let mut tried: Vec<Tried> = Vec::new();
    let mut count = 0;
    let mut order = VISITED;
    permutations(&mut order, 0, &mut |order| {
        count += 1;
        let first = one.pre_estimate(order)?.printed;
        let same = |x: &[f64; 6]| (0..6).all(|k| (x[k] - first[k]).abs() < 1e-9);
        if tried.iter().any(|t| same(&t.0)) {
            return Ok(());
        }
        let products = sums
            .iter()
            .map(|s| s.pre_estimate(order).map(|a| a.printed[3..].to_vec()));
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
    Ok(())
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

fn second_axis(out: &Path) -> Result<(), Failure> {
    let list = second_axis::errors()?;
    let mut csv = "method,element,true,rms_error,stated_sigma,rms_error_percent\n".to_owned();
    println!("\nthree slews in 350 s: rms error in percent of each element");
    println!("  {:<30}{}", "", NAMES.map(|n| format!("{n:>12}")).join(""));
    let percent = |x: &[f64; 6]| -> String {
        let each: Vec<String> = (0..6)
            .map(|k| format!("{:12.2e}", 100.0 * x[k] / TRUE[k]))
            .collect();
        each.join("")
    };
    let printed: [f64; 6] = std::array::from_fn(|k| (PRINTED[3][k] - TRUE[k]).abs());
    println!(
        "  {:<30}{}",
        "printed, suggested (one slew)",
        percent(&printed)
    );
    for errors in &list {
        println!("  {:<30}{}", errors.name, percent(&errors.rms));
        if let Some(sigma) = errors.sigma {
            println!("  {:<30}{}", "    stated sigma", percent(&sigma));
        }
        for (k, element) in NAMES.iter().enumerate() {
            let sigma = errors
                .sigma
                .map_or(String::new(), |s| format!("{:.3e}", s[k]));
            let (rms, share) = (errors.rms[k], 100.0 * errors.rms[k] / TRUE[k]);
            let t = TRUE[k];
            writeln!(
                csv,
                "{},{element},{t},{rms:.3e},{sigma},{share:.3e}",
                errors.name.replace(',', "")
            )?;
        }
    }
    std::fs::write(out.join("second_axis.csv"), csv)?;
    std::fs::write(out.join("second_axis.svg"), figures::second_axis(&list))?;
    Ok(())
}
