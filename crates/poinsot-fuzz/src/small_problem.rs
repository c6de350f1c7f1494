//! A small vehicle and a short record from arbitrary bytes.

use arbitrary::{Result, Unstructured};
use poinsot_telemetry::{Channel, Table};
use std::fmt::Write;
use std::sync::Arc;

/// Largest number of samples.
const SAMPLES: usize = 24;

/// A model file and its telemetry.
pub struct SmallProblem {
    /// Text of the model file, which may be invalid.
    pub model: String,
    /// Measurements as from the readers: finite, at increasing times, attitudes of unit norm.
    pub table: Table,
    /// Method of `identify`.
    pub method: &'static str,
    /// Its variant.
    pub variant: Option<&'static str>,
}

impl SmallProblem {
    /// # Errors
    /// Too few bytes.
    pub fn new(u: &mut Unstructured) -> Result<Self> {
        let mut methods = vec![
            ("linear", None),
            ("auto", None),
            ("maximum_likelihood", Some("huber")),
            ("maximum_likelihood", Some("student_t")),
        ];
        methods.extend(poinsot_papers::METHODS.map(|m| (m.name, None)));
        let (method, variant) = *u.choose(&methods)?;
        let mut model = String::from("schema = \"poinsot.model/1\"\nname = \"fuzzed\"\n");
        let mut columns = Vec::new();
        let joint = *u.choose(&["", "revolute", "prismatic", "fixed"])?;
        bodies(u, &mut model, joint)?;
        match joint {
            "revolute" => columns.extend(["hinge_rad", "hinge_rad_s"]),
            "prismatic" => columns.extend(["hinge_m", "hinge_m_s"]),
            _ => {}
        }
        if u.arbitrary()? {
            let js = number(u, 0.01)?;
            let estimate: bool = u.arbitrary()?;
            let _ = write!(
                model,
                "[[wheel]]\nname = \"wheel\"\nbody = \"bus\"\naxis = [0.0, 0.6, 0.8]\nspin_inertia_kg_m2 = {js:?}\nestimate = {estimate}\n"
            );
            columns.push("wheel_rad_s");
        }
        if u.arbitrary()? {
            model.push_str("[[thruster]]\nname = \"thr\"\nbody = \"bus\"\nposition_m = [0.5, 0.2, 0.0]\nforce_direction = [0.0, 1.0, 0.0]\n");
            columns.push("thr_N");
        }
        sensors(u, &mut model, &mut columns)?;
        momentum(u, &mut model)?;
        Ok(Self {
            model,
            table: record(u, &columns)?,
            method,
            variant,
        })
    }
}

/// Usually of this size, sometimes a limiting value.
fn number(u: &mut Unstructured, size: f64) -> Result<f64> {
    const EDGES: [f64; 9] = [
        0.0,
        -1.0,
        1.0e-12,
        1.0e12,
        1.0e-300,
        1.0e300,
        5.0e-324,
        f64::MAX,
        1.0,
    ];
    if u.ratio(1, 100)? {
        return Ok(*u.choose(&EDGES)?);
    }
    let step: i16 = u.arbitrary()?;
    Ok(size * (1.0 + 0.3 * f64::from(step) / 32768.0))
}

/// A number of either sign.
fn signed(u: &mut Unstructured, size: f64) -> Result<f64> {
    let x = number(u, size)?;
    Ok(if u.arbitrary()? { x } else { -x })
}

fn bodies(u: &mut Unstructured, model: &mut String, joint: &str) -> Result<()> {
    body(u, model, "bus", 50.0)?;
    if joint.is_empty() {
        return Ok(());
    }
    body(u, model, "arm", 8.0)?;
    let x = signed(u, 0.4)?;
    let _ = write!(
        model,
        "[[joint]]\nname = \"hinge\"\ntype = \"{joint}\"\nparent = \"bus\"\nchild = \"arm\"\norigin_m = [{x:?}, 0.1, 0.0]\n"
    );
    if joint != "fixed" {
        model.push_str("axis = [0.0, 0.0, 1.0]\n");
    }
    Ok(())
}

fn body(u: &mut Unstructured, model: &mut String, name: &str, mass: f64) -> Result<()> {
    let m = number(u, mass)?;
    let (x, y, z) = (signed(u, 0.1)?, signed(u, 0.1)?, signed(u, 0.1)?);
    let (xx, yy, zz) = (
        number(u, 0.1 * mass)?,
        number(u, 0.1 * mass)?,
        number(u, 0.1 * mass)?,
    );
    let xy = signed(u, 0.005 * mass)?;
    let estimate: bool = u.arbitrary()?;
    let _ = write!(
        model,
        "[[body]]\nname = \"{name}\"\nmass_kg = {m:?}\ncom_m = [{x:?}, {y:?}, {z:?}]\ninertia_kg_m2 = {{ xx = {xx:?}, yy = {yy:?}, zz = {zz:?}, xy = {xy:?} }}\nestimate = {estimate}\n"
    );
    Ok(())
}

fn sensors(u: &mut Unstructured, model: &mut String, columns: &mut Vec<&str>) -> Result<()> {
    let kinds = [
        (
            "gyro",
            "noise_rad_s",
            &["omega_x", "omega_y", "omega_z"][..],
        ),
        ("attitude", "noise_rad", &["q_x", "q_y", "q_z", "q_w"]),
        ("velocity", "noise_m_s", &["v_x", "v_y", "v_z"]),
        ("position", "noise_m", &["r_x", "r_y", "r_z"]),
    ];
    for (kind, key, names) in kinds {
        if kind != "gyro" && u.ratio(1, 3)? {
            continue;
        }
        let noise = number(u, 1.0e-4)?;
        let bias = kind == "gyro" && u.arbitrary()?;
        let _ = write!(
            model,
            "[[sensor]]\nname = \"{kind}\"\ntype = \"{kind}\"\n{key} = {noise:?}\n"
        );
        if bias {
            model.push_str("bias = \"estimate\"\n");
        }
        columns.extend(names);
    }
    Ok(())
}

fn momentum(u: &mut Unstructured, model: &mut String) -> Result<()> {
    model.push_str("[momentum]\n");
    for key in ["linear_N_s", "angular_N_m_s"] {
        let value = *u.choose(&["\"estimate\"", "[0.0, 0.0, 0.0]", "[1.0, -2.0, 0.5]"])?;
        let _ = writeln!(model, "{key} = {value}");
    }
    Ok(())
}

fn record(u: &mut Unstructured, columns: &[&str]) -> Result<Table> {
    let samples = u.int_in_range(0..=SAMPLES)?;
    let mut time_s: Vec<f64> = Vec::with_capacity(samples);
    let mut t = 0.0;
    for _ in 0..samples {
        time_s.push(t);
        t += *u.choose(&[0.1, 0.1, 0.1, 0.1, 0.1, 1.0e-6, 0.3, 100.0])?;
    }
    let time_s: Arc<[f64]> = time_s.into();
    let mut table = Table::default();
    for name in columns {
        // One name in twenty is missing.
        if u.ratio(1, 20)? {
            continue;
        }
        let size = match *name {
            "wheel_rad_s" => 100.0,
            "thr_N" | "q_w" => 1.0,
            _ => 0.1,
        };
        let mut values = Vec::with_capacity(samples);
        let still = u.ratio(1, 6)?;
        for k in 0..samples {
            let x = if still && k > 0 {
                values[0]
            } else {
                signed(u, size)?
            };
            values.push(x);
        }
        table.channels.push(Channel {
            name: (*name).to_owned(),
            time_s: Arc::clone(&time_s),
            values,
            ..Channel::default()
        });
    }
    normalise(&mut table);
    Ok(table)
}

/// Normalises attitudes as the readers do, or removes their channels.
fn normalise(table: &mut Table) {
    let at = |name: &str| table.channels.iter().position(|c| c.name == name);
    let parts = ["q_x", "q_y", "q_z", "q_w"].map(at);
    let [Some(x), Some(y), Some(z), Some(w)] = parts else {
        table.channels.retain(|c| !c.name.starts_with("q_"));
        return;
    };
    for k in 0..table.channels[x].values.len() {
        let q = [x, y, z, w].map(|c| table.channels[c].values[k].clamp(-1.0e3, 1.0e3));
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        for (c, part) in [x, y, z, w].into_iter().zip(q) {
            let identity = if c == w { 1.0 } else { 0.0 };
            table.channels[c].values[k] = if norm > 1.0e-9 { part / norm } else { identity };
        }
    }
}
