//! The table of `docs/validation/open_set.md`.
//!
//!     cargo run --release -p poinsot --example open_set
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    non_snake_case
)]

mod flown;
#[path = "../../tests/all/vehicle/mod.rs"]
mod vehicle;

use flown::{JOINTS, combinations, flown, functions, system, worst};

fn main() {
    println!(
        "| vehicle | joints | status | iterations | rank | combinations | worst | functions | worst | whole | worst |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    for (k, joints) in JOINTS.iter().enumerate() {
        let (truth, answer) = flown(k);
        let e = &answer.estimate;
        let printed = [combinations, functions, system].map(|of| {
            let z = of(&truth, &answer);
            format!("{} | {:.1}", z.len(), worst(&z))
        });
        println!(
            "| {} | {} | {} | {} | {} of {} | {} |",
            k + 1,
            joints.len(),
            e.status.name(),
            e.iterations,
            e.identifiability.rank,
            e.identifiability.parameters,
            printed.join(" | ")
        );
    }
}
