//! Published methods of identification, one folder per paper: reproduced as printed where correct, and compared with
//! [`poinsot_identify`].
//!
//! [`METHODS`] registers all methods. The command line, `poinsot methods`, help, error codes and tests use this list;
//! no other crate names a paper. [`studies`] recompute the statements of a paper.
//!
//! | module | paper | what it identifies |
//! |---|---|---|
//! | [`kim2010`] | Kim, Choi, Oh 2010 | inertia of one body from the momentum of its wheels |
//! | [`ma2008`] | Ma, Dang, Pham 2008 | the base of a robot from the motion of its arm |
//! | [`xu2017`] | Xu, Hu, Zhang, Liang 2017 | every body of a robot, joint after joint |
//!
//! # Example
//! A method by its name, on a record of `data/ma2008`:
//!
//! ```
#![doc = include_str!("../doc/record.txt")]
//! let input = record("ma2008", "ma2008/model.toml", "ma2008/traj1/telemetry.parquet")?;
//! let estimate = identify_by(method("ma2008").unwrap(), &problem(&input), None, &[])?;
//! // The true mass of the base is 1,000 kg.
//! let mass = estimate.bodies[0].mass;
//! assert!((mass.value.unwrap() - 1000.0).abs() < 3.0 * mass.sigma.unwrap());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! All methods with their variants:
//!
//! ```
//! for method in poinsot_papers::METHODS {
//!     println!("{}: {} ({})", method.name, method.summary, method.citation);
//!     for variant in (method.variants)() {
//!         println!("    {}: {}", variant.name, variant.summary);
//!     }
//! }
//! assert!(poinsot_papers::method("ma2008").is_some());
//! ```
//!
//! # Files
//! - `kim2010/`, `ma2008/`, `xu2017/`: the methods, each with its `studies/`.
//! - `method.rs`: what a method is. `registry.rs`: the list `METHODS`, from which the command line, `poinsot methods`,
//!   `poinsot study`, help and error codes are made.
//! - `numbers.rs`: the ten numbers of a body. `certified.rs`: numbers of a method in the answer that certifies them.
//! - `study/`: input (`context.rs`) and output (`findings.rs`) of a study, noise and quantiles (`statistics.rs`).
//!
//! # Studies
//! Studies simulate cases and run `identify`, which is in the crate `poinsot` above. They call these functions through the trait
//! `study::Tools`. The command `study` (`crates/poinsot/src/study.rs`) implements the trait. Imports therefore point
//! down, a paper stays in one folder, and a study measures what a user's command computes. Two alternatives were
//! rejected. Case files and `identify` below the papers would split one command over two floors. A crate above
//! `poinsot` for studies would split each paper.
#![allow(non_snake_case)]

mod certified;
pub mod kim2010;
pub mod ma2008;
mod method;
mod numbers;
mod registry;
mod samples;
mod setting;
pub mod study;
pub mod xu2017;

pub use method::{Method, Named, VariantText};
pub use numbers::answered;
pub use registry::{METHODS, identify_by, method, studies};
pub use setting::{SettingText, Settings};
