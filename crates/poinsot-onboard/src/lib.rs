//! Mass properties from a stream of samples: a recursive filter for on-board software.
//!
//! [`Filter`] estimates some of the ten inertial parameters of one body of a vehicle, from gyro, attitude and, where it is measured,
//! position. Wheel speeds, positions and rates of joints, thruster force and torque are inputs. It needs neither the standard library
//! nor an allocator at run time, contains no `unsafe`, and its loops have the bounds that [`Configuration`] states.
//!
//! State of the filter, in the order of its columns:
//!
//! ```text
//! x = [e, dphi_B, dh_N, (dp_N, dP_N), (y, p), db, dtheta]
//! ```
//!
//! the present errors of wheel speeds and joints in units of their noise, the changes of attitude, angular momentum about the mass centre,
//! position and linear momentum (where the position is measured), amplitude and momentum of each mode, gyro bias, and unknown parameters. Its information is held as
//! an upper triangle `R` with `R x = z + white noise` (Bierman 1977, chapter 5): `R^T R` cannot lose symmetry or sign, and what is
//! not yet known has a row of zeros.
//!
//! The motion about which all is linearised is the most likely one *at the present parameters*. The first samples are kept and
//! replayed until the parameters stay; see [`Filter::push`].
//!
//! # Files
//! - `numbers.rs`: numbers that stay, and their places. `triangle.rs`: what is known of them.
//! - `configuration.rs`, `check.rs`: vehicle, priors, noise, limits. `table.rs`: the same as checked bytes.
//! - `sample.rs`: what is measured. `stream.rs`: order and clock of samples, the first window.
//! - `layout.rs`, `information.rs`: the triangle. `posture.rs`: the vehicle at one position of its joints. `placed.rs`: the same in motion,
//!   with modes. `excitation.rs`: what of the motion is shown. `slopes.rs`: what parameters do. `motion.rs`: one interval
//!   between samples, with columns.
//! - `filter.rs`: time and measurement updates. `replay.rs`: passes over the first window. `push.rs`: the way in.
//! - `health.rs`: tests of innovations, health word. `answer.rs`: numbers that leave the filter. `ground.rs`: one size of it, compiled here.
#![cfg_attr(not(feature = "std"), no_std)]
#![allow(non_snake_case)]

mod answer;
mod check;
mod configuration;
mod excitation;
mod filter;
mod ground;
mod health;
mod information;
mod layout;
mod motion;
mod numbers;
mod placed;
mod posture;
mod push;
mod replay;
mod sample;
mod slopes;
mod stream;
mod table;
mod triangle;

pub use answer::{Answer, Number};
pub use check::Invalid;
pub use configuration::{Configuration, JOINTS, Joint, Noise, Wheel};
pub use filter::Filter;
pub use ground::GroundFilter;
pub use health::{Health, SensorCounts};
pub use layout::COLUMNS;
pub use numbers::{CURVE, MOUNTING, NUMBERS, WHEELS, of_wheel};
pub use poinsot_dynamics::propagation::Mode;
pub use sample::Sample;
pub use stream::Refusal;
pub use table::{TABLE, TableError};
pub use triangle::Triangle;
