//! `poinsot export`

use super::{Outcome, print};
use crate::arguments::{Export, Format};
use poinsot::export::export_into_urdf;

pub fn run(arguments: &Export) -> Outcome {
    let Format::Urdf = arguments.to;
    let exported = export_into_urdf(&arguments.folder, &arguments.onto)?;
    for line in &exported.left_out {
        eprintln!("{line}");
    }
    match &arguments.out {
        Some(path) => {
            poinsot::write_file(path, exported.text.as_bytes())?;
            eprintln!("written: {}", path.display());
        }
        None => print(&exported.text),
    }
    Ok(u8::from(!exported.left_out.is_empty()))
}
