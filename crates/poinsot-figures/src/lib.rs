//! Documents, tables, plots and pages of numbers. This crate knows nothing about spacecraft.
//!
//! | subject | item |
//! |---|---|
//! | templates of pages and texts, formats of numbers | [`Templates`], [`Html`] |
//! | text in a terminal | [`Document`], [`Section`], [`TextStyle`] |
//! | plots | [`Plot`], [`Series`], [`Axis`], [`Mark`] |
//! | scenes in three dimensions | [`Scene`], [`Tree`], [`Ellipsoid`], [`Curve`] |
//! | a picture as a file | [`Figure`], [`FigureFormat`] |
//! | one HTML file without network | [`Page`], [`Part`], [`Opening`] |
//!
//! # Example
//! ```
//! use minijinja::context;
//! use poinsot_figures::{Axis, Figure, Mark, Plot, Series, Templates};
//!
//! const BUS: &str = "Determined.\n# bus\n| | value | unit |\n| mass | {{ m|value(sigma) }} | kg |\n";
//! let templates = Templates::new(&[("bus.txt", BUS)]);
//! let document = templates.document("bus.txt", context! { m => 312.41567, sigma => 0.0213 });
//! assert!(document.to_string().contains("312.416"));
//!
//! let line = Series::new("mass", Mark::Line, 0, &[0.0, 1.0], &[310.0, 312.0]);
//! let (x, y) = (Axis::new("time", "s"), Axis::new("mass", "kg"));
//! let plot = Plot { title: "Mass".to_owned(), x, y, series: vec![line], height: 200.0, ..Plot::default() };
//! assert!(Figure::plot("mass", plot).svg()?.is_some_and(|svg| svg.contains("<svg")));
//! # Ok::<(), poinsot_figures::PageError>(())
//! ```
//!
//! # Files
//! - `template.rs`: templates (minijinja), escaping, formats of numbers.
//! - `document.rs`, `text.rs`: terminal output.
//! - `page.rs`: one HTML file with its content security policy and its first screen. `assets/page.js`: record selection,
//!   copy, save.
//! - `series.rs`: content of a plot. `plot.rs`, `axis.rs`: SVG.
//! - `packed.rs`: samples of a time plot, drawn by `assets/curves.js` with uPlot.
//! - `scene.rs`, `assets/space.js`: 3D scenes, as SVG and by WebGL2.
//! - `assets/live.js`: the lines of a running filter, as they come.
//! - `figure.rs`: a picture on a page or as a separate SVG or PNG file; PNG needs the feature `png`.

mod axis;
mod document;
mod drawing;
mod error;
mod figure;
mod packed;
mod page;
#[cfg(feature = "png")]
mod pixels;
mod plot;
mod scene;
mod series;
mod template;
mod text;

pub use document::{Document, Section, Tone};
pub use error::PageError;
pub use figure::{Figure, FigureFormat, Picture, WITHOUT_PNG};
pub use page::{Light, Opening, Page, Part};
pub use scene::{Arrow, Curve, Ellipsoid, Hinge, Point, Rolling, Scene, Spot, Tree};
pub use series::{Axis, Mark, Plot, Series};
pub use template::{Html, Templates, escape, half_width, island};
pub use text::{TextStyle, marked_code};
