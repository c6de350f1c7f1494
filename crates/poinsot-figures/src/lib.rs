//! Documents, tables, plots and pages of numbers. This crate knows nothing about spacecraft.
//!
//! | subject | item |
//! |---|---|
//! | text in a terminal | [`Document`], [`Section`], [`Table`], [`TextStyle`] |
//! | plots | [`Plot`], [`Series`], [`Axis`], [`Mark`] |
//! | scenes in three dimensions | [`Scene`], [`Tree`], [`Ellipsoid`], [`Curve`] |
//! | a picture as a file | [`Figure`], [`FigureFormat`] |
//! | one HTML file without network | [`Page`], [`Part`], [`Opening`], [`Html`], [`render`] |
//!
//! # Example
//! ```
//! use poinsot_figures::{Axis, Document, Figure, Mark, Plot, Section, Series, Table};
//! use poinsot_files::number_with_sigma;
//!
//! let (value, sigma) = number_with_sigma(Some(312.41567), Some(0.0213));
//! let mut table = Table::new(&["", "value", "1 sigma", "unit"]);
//! table.push(vec!["mass".to_owned(), value, sigma, "kg".to_owned()]);
//! let mut document = Document::new("Determined.".to_owned());
//! document.push(Section::table("bus", table));
//! assert!(document.to_string().contains("312.416"));
//!
//! let line = Series::new("mass", Mark::Line, 0, &[0.0, 1.0], &[310.0, 312.0]);
//! let (x, y) = (Axis::new("time", "s"), Axis::new("mass", "kg"));
//! let plot = Plot { title: "Mass".to_owned(), x, y, series: vec![line], height: 200.0, ..Plot::default() };
//! assert!(Figure::plot("mass", plot).svg().is_some_and(|svg| svg.contains("<svg")));
//! ```
//!
//! # Files
//! - `document.rs`, `text.rs`: terminal output.
//! - `page.rs`: one HTML file with its content security policy. `markup.rs`: templates (minijinja), escaping.
//! - `series.rs`: content of a plot. `plot.rs`, `axis.rs`: SVG.
//! - `packed.rs`: samples of a time plot, drawn by `assets/curves.js` with uPlot.
//! - `scene.rs`, `assets/space.js`: 3D scenes, as SVG and by WebGL2.
//! - `opening.rs`: first screen of every page. `assets/page.js`: record selection, copy, save.
//! - `figure.rs`: a picture as a separate SVG or PNG file; PNG needs the feature `png`.

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
pub use figure::{Figure, FigureFormat, Picture, WITHOUT_PNG};
pub use markup::{Html, escape, island, render};
pub use opening::{Light, Opening};
pub use page::{Page, Part};
pub use scene::{Arrow, Curve, Ellipsoid, Hinge, Morph, Point, Rolling, Scene, Spot, Tree};
pub use series::{Axis, Mark, Plot, Series};
pub use text::{TextStyle, marked_code};
