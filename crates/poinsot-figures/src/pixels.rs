//! SVG to PNG.

use crate::error::PageError;
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};
use std::sync::Arc;

/// PNG pixels per SVG unit.
const ZOOM: f32 = 2.0;

/// The picture as PNG.
///
/// # Errors
/// The SVG cannot be drawn.
pub(crate) fn pixels(svg: &str) -> Result<Vec<u8>, PageError> {
    let fault = |why: &dyn std::fmt::Display| PageError::Figure(why.to_string());
    let mut options = Options {
        font_family: "DejaVu Sans".to_owned(),
        ..Options::default()
    };
    // The font is embedded, so the result does not depend on installed fonts.
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let tree = Tree::from_str(svg, &options).map_err(|e| fault(&e))?;
    let size = tree.size();
    let side = |x: f32| (x * ZOOM).ceil() as u32;
    let mut pixmap = Pixmap::new(side(size.width()), side(size.height()))
        .ok_or_else(|| fault(&"no room for its pixels"))?;
    pixmap.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(ZOOM, ZOOM),
        &mut pixmap.as_mut(),
    );
    pixmap.encode_png().map_err(|e| fault(&e))
}
