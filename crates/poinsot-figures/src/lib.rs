//! Documents, tables, plots and pages of numbers. This crate knows nothing about spacecraft.

mod axis;
mod document;
mod error;
mod figure;
mod figures;
mod markup;
mod opening;
mod packed;
mod page;
#[cfg(feature = "png")]
mod pixels;
mod plot;
mod scene;
mod series;
mod text;

pub use document::{Content, Document, Section, Table, Tone};
pub use error::PageError;
pub use figure::{Figure, FigureFormat, Picture};
pub use figures::{number_with_sigma, probability, significant};
pub use markup::{Html, escape, island, render};
pub use opening::{Light, Opening};
pub use page::{Page, Part};
pub use scene::{Arrow, Curve, Ellipsoid, Hinge, Morph, Point, Rolling, Scene, Spot, Tree};
pub use series::{Axis, Mark, Plot, Series};
pub use text::{TextStyle, marked_code};
