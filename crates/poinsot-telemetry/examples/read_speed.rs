//! Time to read a table: eight channels of thirty columns.
//!
//!     cargo run --release -p poinsot-telemetry --example read_speed -- FILE.csv FILE.parquet
//!
//! Prints `name,value,unit`. `scripts/bench-read` writes the files and runs the peers beside it.

use poinsot_telemetry::{ReadOptions, read};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Times that every file is read; the fastest counts.
const READS: usize = 5;
/// Channels that are read.
const CHANNELS: [&str; 7] = [
    "omega_x",
    "omega_y",
    "omega_z",
    "wheel1_rad_s",
    "wheel2_rad_s",
    "wheel3_rad_s",
    "wheel4_rad_s",
];

fn main() -> Result<(), Box<dyn Error>> {
    let options = ReadOptions {
        wanted: Some(CHANNELS.map(str::to_owned).into()),
        ..ReadOptions::default()
    };
    for file in std::env::args().skip(1) {
        let path = Path::new(&file);
        let kind = path.extension().and_then(|e| e.to_str()).unwrap_or("csv");
        let (mut seconds, mut samples, mut sum) = (f64::INFINITY, 0, 0.0);
        for _ in 0..READS {
            let began = Instant::now();
            let table = read(&[path], &options)?;
            seconds = seconds.min(began.elapsed().as_secs_f64());
            let values = table.channels.iter().flat_map(|c| &c.values);
            (samples, sum) = (table.channels.len(), values.sum());
        }
        println!("poinsot_read_{kind},{seconds:.4},s");
        println!("poinsot_read_{kind}_channels,{samples},1");
        println!("poinsot_read_{kind}_sum,{sum:.9e},1");
    }
    Ok(())
}
