//! Each column for a slew about one axis, and the record inferred from the printed numbers.

use super::inversion::{Noise, invert};
use super::records::{PAPER, PRINTED, RATE, SIGMA, Slew, TRUE, chi_square, columns, noise};
use crate::kim2010::{Answer, ELEMENTS, NAMES, Sums, VISITED};
use crate::study::statistics::largest;
use crate::study::{Context, Digits, Findings, StudyError, Table};
use poinsot_files::Faults;
use poinsot_spatial::Matrix3;

/// `N sigma^2 / sum s^2` in the limit of low noise.
const SMALL_RIDGE: f64 = 1.0e-5;

/// Direction of the rates, deviation from it, and the ratio of the conventional products. On one axis `Q = I n s`, so
/// `sum Q_x w_y / sum Q_y w_y = (I n)_x / (I n)_y` for any noise of the rates.
pub fn axis(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let n = slew.normal();
    let across = largest(slew.w.iter().map(|w| (w - n * w.dot(&n)).norm()));
    let along = largest(slew.w.iter().map(|w| w.norm()));
    let mut table = Table::new(
        "axis",
        "Axis n of the slew; rate along it and across it, rad/s",
        " | n_x :.4 | n_y :.4 | n_z :.4 | along :4 | across",
    );
    table.row("slew", [n.x, n.y, n.z, along, across]);
    let (In, m) = (slew.I * n, &PRINTED[1]);
    let mut products = Table::new(
        "products",
        "Conventional products, kg m2: from the printed moments and I n alone, and as printed",
        " | I_xy :.4 | I_yz :.4 | I_zx :.4",
    );
    let follows =
        [(0, 1), (1, 2), (2, 0)].map(|(i, j)| 0.5 * (m[j] * In[i] / In[j] + m[i] * In[j] / In[i]));
    products.row("from the moments", follows);
    products.row("printed", [m[3], m[4], m[5]]);
    Ok(Findings::of([table, products]).say(&[
        "(17) control law = {axis.0.5} rad/s across the axis",
        "one-axis manoeuvres are impossible with products = {axis.0.5} rad/s across the axis",
    ]))
}

/// Each column without noise.
pub fn table2(context: &Context) -> Result<Findings, StudyError> {
    let found = columns(&Slew::of(context)?.sums(PAPER.0, PAPER.1, &[])?)?;
    let mut table = Table::new(
        "columns",
        "Table 2 without noise, and as printed, kg m2",
        " | true :5 | batch :.3 | printed :.3 | conventional :.3 | printed :.3 | suggested :.3 | printed :.3",
    );
    for (k, name) in NAMES.iter().enumerate() {
        let pairs = [0, 1, 3].map(|c| [found[c][k], PRINTED[c][k]]);
        let cells = [TRUE[k]].into_iter().chain(pairs.into_iter().flatten());
        table.row(name, cells);
    }
    let off = |k: usize| 100.0 * (found[1][k] / TRUE[k] - 1.0);
    let most = largest(found[3][3..].iter().map(|x| x.abs()));
    let mut findings = Findings::of([table]);
    let text = format!("{:.1}, {:.1}, {:.1} %", off(0), off(1), off(2));
    findings.state("(11)-(14) moments alone", text);
    let text = format!("{most:.0e} kg m2, printed 0.12 to 0.16");
    findings.state("(15), (16) suggested products", text);
    Ok(findings.say(&[
        "conventional: moments well estimated, products not = products {columns.3.4:.1}, {columns.4.4:.1}, {columns.5.4:.1} kg m2, true 0.085, 0.590, 0.133",
    ]))
}

/// The column "Considering pre-estimate" from the sums fixed by the other columns, and the inferred record.
pub fn pre_estimate(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let n = slew.normal();
    let fixed = invert(&n, &(slew.I * n), &PRINTED)?;
    let found = fixed.sums.pre_estimate()?.printed;
    let ordered = fixed.sums.pre_estimate_in_order(&VISITED)?.printed;
    let mut readings = Table::new(
        "readings",
        "Products considering pre-estimate, kg m2, from the sums that 15 printed numbers fix",
        "reading | I_xy :.4 | I_yz :.4 | I_zx :.4",
    );
    readings.row("printed", PRINTED[2][3..].iter().copied());
    let at_once = "every product with the other product of its row as (15) gives it, all at once";
    readings.row(at_once, []);
    let five = Digits::Decimals(5);
    found[3..].iter().for_each(|x| readings.with(*x, five));
    let by_columns = "one after the other, column by column [1]";
    readings.row(by_columns, ordered[3..].iter().copied());
    // Integral of s^2 over the slew, which ends long before the record.
    let squares: f64 = slew.w.iter().map(|w| w.dot(&n).powi(2)).sum();
    let integral = squares / RATE as f64;
    let noise = Noise::of(&fixed, &n);
    let mut record = Table::new("record", "The record behind the sums", " | number :.2");
    let misfit = "largest misfit of the 15 numbers, half digits";
    record.row(misfit, [fixed.worst]);
    record.row("length of the record, s", []);
    record.with(noise.length(SIGMA, integral), Digits::Decimals(0));
    let shift = "common shift of the rates against Q, %";
    record.row(shift, [100.0 * noise.along]);
    let mut rates = Table::new(
        "rates",
        "Residual sums as white gyro noise at a rate: chi-square on 6, common shift in sigmas",
        "rate, Hz | chi-square :.1 | shift :.1",
    );
    for rate in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0] {
        let (scatter, along) = noise.at(rate, SIGMA, integral);
        rates.row(format!("{rate}"), [scatter, along]);
    }
    Ok(Findings::of([readings, record, rates]).say(&[
        "Table 2, Considering pre-estimate = {readings.1.1}, {readings.1.2}, {readings.1.3} kg m2",
    ]))
}

/// The sequential interpretations of "considering pre-estimate" in every order of the six products: chi-square of the
/// three printed products at 350 s and 1 Hz. Compared with the interpretation that computes all at once.
pub fn orders(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let sums = slew.noisy(PAPER.1, &[PAPER.0])?.swap_remove(0);
    let mut all = Vec::new();
    permutations(&mut VISITED.clone(), 0, &mut all);
    // The first result and order of each distinct interpretation.
    let mut tried: Vec<([f64; 6], Order)> = Vec::new();
    for order in &all {
        let first = sums[0].pre_estimate_in_order(order)?.printed;
        let same = |x: &[f64; 6]| (0..6).all(|k| (x[k] - first[k]).abs() < 1e-9);
        if !tried.iter().any(|t| same(&t.0)) {
            tried.push((first, *order));
        }
    }
    let far = |of: &dyn Fn(&Sums) -> Result<Answer, Faults>| -> Result<f64, Faults> {
        let products = sums.iter().map(|s| of(s).map(|a| a.printed[3..].to_vec()));
        Ok(chi_square(&products.collect::<Result<Vec<_>, _>>()?, 2, 3))
    };
    let mut best = f64::INFINITY;
    for (_, order) in &tried {
        best = best.min(far(&|s| s.pre_estimate_in_order(order))?);
    }
    let mut table = Table::new(
        "orders",
        "Chi-square on 3 of the printed products among 200 noisy records of 350 s at 1 Hz",
        "reading | answers that differ :.0 | smallest chi-square :.1",
    );
    let title = format!("one after the other, {} orders", all.len());
    table.row(title, [tried.len() as f64, best]);
    table.row("all at once", [1.0, far(&Sums::pre_estimate)?]);
    Ok(Findings::of([table]))
}

/// Rows and columns of the six products, in computation order.
type Order = [(usize, usize); 6];

fn permutations(order: &mut Order, from: usize, all: &mut Vec<Order>) {
    if from == order.len() {
        all.push(*order);
    }
    for k in from..order.len() {
        order.swap(from, k);
        permutations(order, from + 1, all);
        order.swap(from, k);
    }
}

/// The announced iteration for the paper's slew, compared with the symmetric fit.
pub fn iteration(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let mut table = Table::new(
        "iteration",
        "Iteration of (14) to (16) on the paper's slew",
        "record | sweeps :.0 | spectral radius :.3 | free directions :.0",
    );
    let mut ends = Table::new(
        "ends",
        "Where it ends, kg m2",
        "record | xx :.2 | yy :.2 | zz :.2 | xy :.2 | yz :.2 | zx :.2",
    );
    for seed in [None, Some(0), Some(1), Some(2)] {
        let noise = seed.map_or(Vec::new(), |s| noise(s, 351));
        let it = slew.sums(PAPER.0, PAPER.1, &noise)?.iterated()?;
        let name = seed.map_or("no noise".to_owned(), |s| format!("noise, seed {s}"));
        let free = it.free_directions as f64;
        table.row(&name, [it.sweeps as f64, it.spectral_radius, free]);
        ends.row(&name, it.answer.printed);
    }
    // Limit of low noise: a ridge that is negligible compared with the motion.
    let n = slew.normal();
    let g = slew.I * n;
    let G = n * n.transpose() + Matrix3::identity() * SMALL_RIDGE;
    let limit = Sums::at_rest(G, g * n.transpose(), PAPER.0)?.iterated()?;
    let fixed = limit.fixed_point.unwrap_or([f64::NAN; 6]);
    ends.row("little noise, fixed point", fixed);
    // The symmetric tensor of least Frobenius norm with `I n = g`. Least squares tends to it as noise, which adds
    // `N sigma^2 |I|^2` to the sum of squares, goes to zero.
    let I = g * n.transpose() + n * g.transpose() - n * n.transpose() * g.dot(&n);
    let fit = "little noise, symmetric least squares";
    ends.row(fit, ELEMENTS.map(|e| I[e]));
    Ok(Findings::of([table, ends]))
}
