//! Inertia of two objects from single throws by hand, after Blaha et al. (arXiv:2503.13137).
//!
//!     cargo run --release -p poinsot --example tudelft_throw -- ../shared/data/real/tudelft_throw
//!
//! Options: `--cut-off-hz 40`, `--window-s 0.05`, `--start-s 0.074`. See `data/tudelft_throw/README.md`.
#![allow(non_snake_case)]

mod throws;

use std::path::PathBuf;
use throws::{Answer, Calibration, Fault, Object, Settings, evaluate};

fn main() -> Result<(), Fault> {
    let (folder, settings) = arguments()?;
    if !folder.join("throws.parquet").exists() {
        println!("skipped: no shared data");
        return Ok(());
    }
    println!(
        "low-pass {} Hz, windows of {} s, from {} s after the start of the wheel",
        settings.cut_off_hz, settings.window_s, settings.start_s
    );
    let found = evaluate(&folder, &settings)?;
    print_calibration(&found.calibration);
    found.objects.iter().for_each(print_object);
    print_summary(&found.objects);
    Ok(())
}

fn arguments() -> Result<(PathBuf, Settings), Fault> {
    let mut folder = None;
    let mut settings = Settings::default();
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let slot = match word.as_str() {
            "--cut-off-hz" => &mut settings.cut_off_hz,
            "--window-s" => &mut settings.window_s,
            "--start-s" => &mut settings.start_s,
            _ => {
                folder = Some(PathBuf::from(word));
                continue;
            }
        };
        let text = words
            .next()
            .ok_or_else(|| format!("{word}: a number is missing"))?;
        *slot = text
            .parse()
            .map_err(|_| format!("{word} {text}: not a number"))?;
    }
    let folder = folder.unwrap_or_else(|| PathBuf::from("../shared/data/real/tudelft_throw"));
    Ok((folder, settings))
}

fn print_calibration(c: &Calibration) {
    println!("\nbox alone (device_only), principal moments over J");
    for (name, m) in &c.box_throws {
        println!("  {name}  {:8.3} {:8.3} {:8.3}", m[0], m[1], m[2]);
    }
    println!("\nwheel (proof_body: box and known block), J in 1e-6 kg m2");
    for (name, J) in &c.proof_throws {
        println!("  {name}  {:.4}", 1.0e6 * J);
    }
    println!("  all       {:.4}", 1.0e6 * c.J);
    let e = c.proof_error;
    println!(
        "  block with this J: moments {:+.2} {:+.2} {:+.2} %",
        e[0], e[1], e[2]
    );
}

fn print_object(object: &Object) {
    let k = object.known.map(|m| 1.0e6 * m);
    println!(
        "\n{}: principal moments in 1e-6 kg m2, known {:.2} {:.2} {:.2}",
        object.name, k[0], k[1], k[2]
    );
    println!(
        "  throw       moments                       errors, %               mass centre from the accelerometer, mm"
    );
    object.throws.iter().for_each(print_answer);
    for (name, why) in &object.undetermined {
        println!("  {name:8} not determined: {why}");
    }
    print_answer(&object.together);
}

fn print_answer(a: &Answer) {
    let m = a.moments.map(|m| 1.0e6 * m);
    let c = a.p_Sc_B * 1.0e3;
    println!(
        "  {:8} {:9.2} {:9.2} {:9.2}   {:+6.2} {:+6.2} {:+6.2}   {:7.2} {:7.2} {:7.2}",
        a.name, m[0], m[1], m[2], a.error[0], a.error[1], a.error[2], c.x, c.y, c.z
    );
}

fn print_summary(objects: &[Object]) {
    println!("\nerror of the principal moments, throw by throw; published: 2 % mean");
    for object in objects {
        println!(
            "  {:12} {:2} throws: mean {:.2} %, worst {:.2} %; all throws together {:+.2} {:+.2} {:+.2} %",
            object.name,
            object.throws.len(),
            object.mean_error(),
            object.worst_error(),
            object.together.error[0],
            object.together.error[1],
            object.together.error[2]
        );
    }
}
