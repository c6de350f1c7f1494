//! Published methods of identification, one folder per paper: reproduced as printed where correct, and compared with
//! [`poinsot_identify`].
//!
//! [`METHODS`] registers all methods. The command line, `poinsot methods`, help, error codes and tests use this list;
//! no other crate names a paper. [`studies`] recompute the statements of a paper.
//!
//! ```
//! for method in poinsot_papers::METHODS {
//!     let about = method.about();
//!     println!("{}: {} ({})", about.name, about.summary, about.citation);
//!     for variant in about.variants {
//!         println!("    {}: {}", variant.name, variant.summary);
//!     }
//! }
//! assert!(poinsot_papers::method("ma2008").is_some());
//! ```
#![allow(non_snake_case)]

mod answered;
mod certified;
mod error;
pub mod kim2010;
pub mod ma2008;
mod method;
mod registry;
mod setting;
pub mod study;
pub mod xu2017;

pub use answered::answered;
pub use error::MethodError;
pub use method::{About, Kernel, Method, Named, VariantText};
pub use registry::{METHODS, identify_by, method, studies};
pub use setting::{SettingText, Settings};
