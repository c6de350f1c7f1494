//! The vehicle: a tree of rigid bodies with joints, wheels, thrusters and sensors, read and checked.
//!
//! [`read_model`] reads a `poinsot.model/1` file into a [`Model`], or returns a [`Faults`](poinsot_files::Faults) with all faults. The
//! raw file (`file`) and the checked vehicle are separate types: invalid data never reach the vehicle.
//!
//! | subject | item |
//! |---|---|
//! | the vehicle | [`Model`], [`Body`], [`Joint`], [`Wheel`], [`Thruster`], [`FlexibleMode`], [`Sensor`], [`Momentum`], [`Environment`] |
//! | known and uncertain numbers | [`Knowledge`], [`KnownNumber`] |
//! | reading and writing | [`read_model`], [`parse_model`], [`write_model`], [`read_urdf`], [`parse_urdf`] |
//! | mass properties into files of other programs | [`patch_urdf`], [`patch_sdf`], [`patch_mjcf`], [`patch_model`] |
//! | map of telemetry columns | [`TelemetryMap`], [`read_telemetry_map`] |
//! | description and schema | [`describe()`], [`model_schema`] |
//!
//! # Example
//! ```
//! use poinsot_dynamics::Tree;
//! use poinsot_model::{SensorKind, parse_model};
//!
//! let model = parse_model(
//!     r#"
//! schema = "poinsot.model/1"
//! name = "box"
//! exact = true
//!
//! [[body]]
//! name = "bus"
//! mass_kg = 10.0
//! com_m = [0.0, 0.0, 0.0]
//! inertia_kg_m2 = { xx = 1.0, yy = 2.0, zz = 2.5 }
//! estimate = ["inertia"]
//!
//! [[sensor]]
//! name = "gyro"
//! type = "gyro"
//! noise_rad_s = 1.0e-4
//! "#,
//!     "box.toml",
//! )?;
//! let bus = &model.bodies[0];
//! assert_eq!((bus.name.as_str(), bus.nominal.I_BBcm_B[(2, 2)]), ("bus", 2.5));
//! assert_eq!(model.sensors_of(SensorKind::Gyro).count(), 1);
//! // The kinematic constants for the kernels of `poinsot-dynamics`.
//! assert_eq!(Tree::new(&model).bodies(), 1);
//! # Ok::<(), poinsot_files::Faults>(())
//! ```
//!
//! # Files
//! - `file/`: the table of keys, one type per table and one field per key: path, unit, range, words. `schema.rs`: JSON Schema
//!   from it.
//! - `shape.rs`: checks a file against the table.
//! - `check.rs`, `check_*.rs`: what rows cannot say, from raw to checked; every finding is reported.
//! - `vehicle.rs`: the checked `Model`. `known.rs`: uncertainty of known numbers, in one table.
//! - `posterior.rs`: what an earlier answer told of the unknown ones.
//! - `kinematic.rs`: conversion to the tree. `write.rs`: fills the table of keys, which `toml` writes.
//! - `describe.rs`: description for `check`; `words.rs`: any table of keys in words. `finding.rs`: codes E01xx.
//! - `urdf/`: reading URDF. `urdf/limits.rs`: limits checked before a tree is built. `vehicle_file.rs`: a file of either kind.
//! - `patch/`: writing mass properties into URDF, SDF, MJCF and model files.
#![allow(non_snake_case)]

mod check;
mod check_body;
mod check_joint;
mod check_known;
mod check_mode;
mod check_name;
mod check_rest;
mod check_rotation;
mod check_sensor;
mod check_telemetry;
mod check_tree;
mod describe;
mod document;
mod file;
mod finding;
mod kinematic;
mod knowledge;
mod known;
mod model_text;
mod patch;
mod posterior;
mod read;
mod schema;
mod shape;
mod suggest;
mod toml_text;
mod urdf;
mod vehicle;
mod vehicle_file;
mod words;
mod write;

pub use describe::*;
pub use file::{
    JointFile, ModeFile, ModeParameter, SlopeFile, SpringDamperFile, SpringParameter, ThrusterFile,
    WheelFile, Which,
};
pub use knowledge::{
    Knowledge, KnownNumber, LIKE_WHEELS, NOMINAL_WITHIN, Origin, Uncertain, across,
};
pub use known::RoundStep;
pub use model_text::read_model_text;
pub use patch::{
    BodyProperties, Measured, PartNumber, Patch, Patched, patch_mjcf, patch_model, patch_sdf,
    patch_urdf,
};
pub use poinsot_files::rounded;
pub use poinsot_telemetry::TelemetryMap;
pub use posterior::{Posterior, PosteriorKnown};
pub use read::{check_keys, locate, parse_model, parse_telemetry_map, read_telemetry_map};
pub use schema::{model_schema, telemetry_map_schema, without_null};
pub use shape::{Format, MODEL_SCHEMA};
pub use urdf::{Urdf, UrdfOptions, parse_urdf, read_urdf, read_urdf_with};
pub use vehicle::*;
pub use vehicle_file::{read_model, read_robot};
pub use write::write_model;
