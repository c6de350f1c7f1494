//! Documents, tables, plots and pages of numbers. This crate knows nothing about spacecraft.
//!
//! # Files
//! - `document.rs`, `text.rs`: terminal output.
//! - `page.rs`: one HTML file with its content security policy. `markup.rs`: templates (minijinja), escaping.
//! - `series.rs`: content of a plot. `plot.rs`, `axis.rs`: SVG.
//! - `packed.rs`: samples of a time plot, drawn by `assets/curves.js` with uPlot.
//! - `scene.rs`, `assets/space.js`: 3D scenes, as SVG and by WebGL2.
//! - `opening.rs`: first screen of every page. `assets/page.js`: record selection, copy, save.
//! - `figure.rs`: a picture as a separate SVG or PNG file.

mod axis;
mod document;
mod error;
mod figure;
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
pub use markup::{Html, escape, island, render};
pub use opening::{Light, Opening};
pub use page::{Page, Part};
pub use scene::{Arrow, Curve, Ellipsoid, Hinge, Morph, Point, Rolling, Scene, Spot, Tree};
pub use series::{Axis, Mark, Plot, Series};
pub use text::{TextStyle, marked_code};
