//! Each column for a slew about one axis, and the record inferred from the printed numbers.

use super::inversion::{Noise, invert};
use super::printed::{COLUMNS, PRINTED, SIGMA, TRUE};
use super::records::{PAPER, RATE, Slew, chi_square, columns, noise};
use crate::kim2010::{ELEMENTS, Kim2010Error, NAMES, Sums, VISITED};
use crate::study::statistics::largest;
use crate::study::{Context, Findings, StudyError, Table, decimals, figures, word};
use poinsot_spatial::{Matrix3, Vector3};

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
        "n_x | n_y | n_z | along | across",
    );
    let mut row: Vec<_> = n.iter().map(|x| decimals(*x, 4)).collect();
    row.extend([figures(along, 4), figures(across, 2)]);
    table.rows.push(row);
    let mut findings = Findings::of(table);
    let (In, m) = (slew.I * n, &PRINTED[1]);
    let mut products = Table::new(
        "products",
        "Conventional products, kg m2: from the printed moments and I n alone, and as printed",
        " | I_xy | I_yz | I_zx",
    );
    let follows =
        [(0, 1), (1, 2), (2, 0)].map(|(i, j)| 0.5 * (m[j] * In[i] / In[j] + m[i] * In[j] / In[i]));
    products.row("from the moments", follows.map(|x| decimals(x, 4)));
    products.row("printed", [m[3], m[4], m[5]].map(|x| decimals(x, 4)));
    findings.tables.push(products);
    let keeps = format!("{across:.1e} rad/s across the axis");
    findings.state("(17) control law", keeps.clone());
    findings.state("one-axis manoeuvres are impossible with products", keeps);
    Ok(findings)
}

/// Each column without noise.
pub fn table2(context: &Context) -> Result<Findings, StudyError> {
    let found = columns(&Slew::of(context)?.sums(PAPER.0, PAPER.1, &[])?)?;
    let mut table = Table::new(
        "columns",
        "Table 2 without noise, and as printed, kg m2",
        " | true | batch | printed | conventional | printed | suggested | printed",
    );
    for (k, name) in NAMES.iter().enumerate() {
        let pairs = [0, 1, 3].map(|c| [found[c][k], PRINTED[c][k]].map(|x| decimals(x, 3)));
        let cells = std::iter::once(figures(TRUE[k], 5)).chain(pairs.into_iter().flatten());
        table.row(*name, cells);
    }
    let mut findings = Findings::of(table);
    let off = |k: usize| 100.0 * (found[1][k] / TRUE[k] - 1.0);
    let moments = format!("{:.1}, {:.1}, {:.1} %", off(0), off(1), off(2));
    findings.state("(11)-(14) moments alone", moments);
    let [a, b, c] = [3, 4, 5].map(|k| found[1][k]);
    findings.state(
        "conventional: moments well estimated, products not",
        format!("products {a:.1}, {b:.1}, {c:.1} kg m2, true 0.085, 0.590, 0.133"),
    );
    let most = largest(found[3][3..].iter().map(|x| x.abs()));
    let [a, b] = [3, 5].map(|k| PRINTED[3][k]);
    let products = format!("{most:.0e} kg m2, printed {a:.2} to {b:.2}");
    findings.state("(15), (16) suggested products", products);
    Ok(findings)
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
        "reading | I_xy | I_yz | I_zx",
    );
    readings.row("printed", PRINTED[2][3..].iter().map(|x| decimals(*x, 4)));
    readings.row(
        "every product with the other product of its row as (15) gives it, all at once",
        found[3..].iter().map(|x| decimals(*x, 5)),
    );
    readings.row(
        "one after the other, column by column [1]",
        ordered[3..].iter().map(|x| decimals(*x, 4)),
    );
    // Integral of s^2 over the slew, which ends long before the record.
    let squares: f64 = slew.w.iter().map(|w| w.dot(&n).powi(2)).sum();
    let integral = squares / RATE as f64;
    let noise = Noise::of(&fixed, &n);
    let mut record = Table::new("record", "The record behind the sums", " | number");
    record.row(
        "largest misfit of the 15 numbers, half digits",
        [decimals(fixed.worst, 2)],
    );
    record.row(
        "length of the record, s",
        [decimals(noise.length(SIGMA, integral), 0)],
    );
    record.row(
        "common shift of the rates against Q, %",
        [decimals(100.0 * noise.along, 2)],
    );
    let mut rates = Table::new(
        "rates",
        "Residual sums as white gyro noise at a rate: chi-square on 6, common shift in sigmas",
        "rate, Hz | chi-square | shift",
    );
    for rate in [0.5, 1.0, 2.0, 5.0, 10.0, 20.0] {
        let (scatter, along) = noise.at(rate, SIGMA, integral);
        rates.row(
            format!("{rate}"),
            [decimals(scatter, 1), decimals(along, 1)],
        );
    }
    let mut findings = Findings::of(readings);
    findings.tables.extend([record, rates]);
    let three = format!("{:.5}, {:.5}, {:.5} kg m2", found[3], found[4], found[5]);
    findings.state("Table 2, Considering pre-estimate", three);
    Ok(findings)
}

/// The sequential interpretations of "considering pre-estimate" in every order of the six products: chi-square of the
/// three printed products at 350 s and 1 Hz. Compared with the interpretation that computes all at once.
pub fn orders(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let sums = slew.noisy(PAPER.1, &[PAPER.0])?.swap_remove(0);
    let one = &sums[0];
    // First result and order of each distinct interpretation.
    let mut tried: Vec<([f64; 6], Order)> = Vec::new();
    let (mut order, mut count) = (VISITED, 0);
    permutations(&mut order, 0, &mut |order| {
        count += 1;
        let first = one.pre_estimate_in_order(order)?.printed;
        let same = |x: &[f64; 6]| (0..6).all(|k| (x[k] - first[k]).abs() < 1e-9);
        if !tried.iter().any(|t| same(&t.0)) {
            tried.push((first, *order));
        }
        Ok(())
    })?;
    let far = |answers: Vec<[f64; 6]>| {
        let products: Vec<Vec<f64>> = answers.iter().map(|a| a[3..].to_vec()).collect();
        chi_square(&products, 2, 3)
    };
    let mut distances = Vec::new();
    for (_, order) in &tried {
        let answers = sums
            .iter()
            .map(|s| Ok(s.pre_estimate_in_order(order)?.printed));
        distances.push(far(answers.collect::<Result<_, Kim2010Error>>()?));
    }
    let answers = sums.iter().map(|s| Ok(s.pre_estimate()?.printed));
    let at_once = far(answers.collect::<Result<_, Kim2010Error>>()?);
    let mut table = Table::new(
        "orders",
        "Chi-square on 3 of the printed products among 200 noisy records of 350 s at 1 Hz",
        "reading | answers that differ | smallest chi-square",
    );
    let best = distances.iter().copied().fold(f64::INFINITY, f64::min);
    table.row(
        format!("one after the other, {count} orders"),
        [figures(tried.len() as f64, 2), decimals(best, 1)],
    );
    table.row("all at once", [word("1"), decimals(at_once, 1)]);
    Ok(Findings::of(table))
}

/// Rows and columns of the six products, in computation order.
type Order = [(usize, usize); 6];
type Visit<'v> = &'v mut dyn FnMut(&Order) -> Result<(), Kim2010Error>;

fn permutations(order: &mut Order, from: usize, visit: Visit) -> Result<(), Kim2010Error> {
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

/// The announced iteration for the paper's slew, compared with the symmetric fit.
pub fn iteration(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let mut table = Table::new(
        "iteration",
        "Iteration of (14) to (16) on the paper's slew",
        "record | sweeps | spectral radius | free directions",
    );
    let mut ends = Table::new(
        "ends",
        "Where it ends, kg m2",
        "record | xx | yy | zz | xy | yz | zx",
    );
    for seed in [None, Some(0), Some(1), Some(2)] {
        let noise = seed.map_or(Vec::new(), |s| noise(s, 351));
        let it = slew.sums(PAPER.0, PAPER.1, &noise)?.iterated()?;
        let name = seed.map_or("no noise".to_owned(), |s| format!("noise, seed {s}"));
        let free = it.free_directions as f64;
        let cells = [
            decimals(it.sweeps as f64, 0),
            decimals(it.spectral_radius, 3),
        ];
        table.row(name.clone(), cells.into_iter().chain([decimals(free, 0)]));
        ends.row(name, it.answer.printed.map(|x| decimals(x, 2)));
    }
    // Limit of low noise: a ridge that is negligible compared with the motion.
    let n = slew.normal();
    let g = slew.I * n;
    let G = n * n.transpose() + Matrix3::identity() * SMALL_RIDGE;
    let limit = Sums::at_rest(G, g * n.transpose(), PAPER.0)?.iterated()?;
    let fixed = limit.fixed_point.unwrap_or([f64::NAN; 6]);
    ends.row("little noise, fixed point", fixed.map(|x| decimals(x, 2)));
    let I = symmetric_fit(&n, &g);
    ends.row(
        "little noise, symmetric least squares",
        ELEMENTS.map(|e| decimals(I[e], 2)),
    );
    let mut findings = Findings::of(table);
    findings.tables.push(ends);
    Ok(findings)
}

/// The symmetric tensor of least Frobenius norm with `I n = g`. Least squares tends to it as noise, which adds
/// `N sigma^2 |I|^2` to the sum of squares, goes to zero.
fn symmetric_fit(n: &Vector3, g: &Vector3) -> Matrix3 {
    g * n.transpose() + n * g.transpose() - n * n.transpose() * g.dot(n)
}

/// Column titles, one for each column of the paper.
pub(super) fn titles() -> String {
    format!(" | {}", COLUMNS.join(" | "))
}
