//! Each column for a slew about one axis, and the record inferred from the printed numbers.

use super::inversion::invert;
use super::records::{PAPER, PRINTED, Slew, TRUE, columns};
use crate::kim2010::NAMES;
use crate::study::statistics::largest;
use crate::study::{Context, Findings, StudyError, Table};

/// Direction of the rates, deviation from it, and the ratio of the conventional products. On one axis `Q = I n s`, so
/// `sum Q_x w_y / sum Q_y w_y = (I n)_x / (I n)_y` for any noise of the rates.
pub fn axis(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let n = slew.normal();
    let across = largest(slew.w.iter().map(|w| (w - n * w.dot(&n)).norm()));
    let along = largest(slew.w.iter().map(|w| w.norm()));
    let title = "Axis n of the slew; rate along it and across it, rad/s";
    let head = " | n_x :.4 | n_y :.4 | n_z :.4 | along :4 | across";
    let mut table = Table::new("axis", title, head);
    table.row("slew", [n.x, n.y, n.z, along, across]);
    let (In, m) = (slew.I * n, &PRINTED[1]);
    let title =
        "Conventional products, kg m2: from the printed moments and I n alone, and as printed";
    let mut products = Table::new("products", title, " | I_xy :.4 | I_yz :.4 | I_zx :.4");
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
    let title = "Table 2 without noise, and as printed, kg m2";
    let head = " | true :5 | batch :.3 | printed :.3 | conventional :.3 | printed :.3 | suggested :.3 | printed :.3";
    let mut table = Table::new("columns", title, head);
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

/// The column "Considering pre-estimate" from the sums fixed by the other columns.
pub fn pre_estimate(context: &Context) -> Result<Findings, StudyError> {
    let slew = Slew::of(context)?;
    let n = slew.normal();
    let fixed = invert(&n, &(slew.I * n), &PRINTED)?;
    let found = fixed.sums.pre_estimate()?.printed;
    let mut readings = Table::new(
        "readings",
        "Products considering pre-estimate, kg m2, from the sums that 15 printed numbers fix",
        "reading | I_xy :.5 | I_yz :.5 | I_zx :.5 | largest misfit of the 15 numbers, half digits",
    );
    let printed = PRINTED[2][3..].iter().copied();
    readings.row("printed", printed.chain([f64::NAN]));
    let at_once = "every product with the other product of its row as (15) gives it, all at once";
    readings.row(at_once, found[3..].iter().copied().chain([fixed.worst]));
    Ok(Findings::of([readings]).say(&[
        "Table 2, Considering pre-estimate = {readings.1.1}, {readings.1.2}, {readings.1.3} kg m2",
    ]))
}
