//! The record of the example: a bus with four wheels and thrusters, all ten parameters unknown, 600 samples at 5 Hz.

use crate::setups;
use crate::truth::{Noise, samples};
use poinsot_onboard::Configuration;
use poinsot_onboard_c::{MEASURED_ATTITUDE, MEASURED_GYRO, MEASURED_POSITION, Sample};

/// What the filter is told, and its samples.
pub struct Record {
    pub configuration: Configuration,
    pub samples: Vec<Sample>,
}

pub fn record() -> Record {
    let (mut setup, wheels) = (setups::bus_with_thrusters(), setups::bus_with_wheels());
    setup.truth.motors = wheels.truth.motors;
    for wheel in &wheels.configuration.wheels[..wheels.configuration.wheel_count] {
        setup.configuration = setup.configuration.with_wheel(*wheel);
    }
    let mut noise = Noise::new(52);
    let motions = setup.truth.motions(&setup.configuration);
    let stream = samples(
        &setup.truth,
        &setup.configuration,
        &motions,
        Some(&mut noise),
    );
    let mut configuration = setup.configuration;
    for (nominal, sigma) in configuration.nominal.iter_mut().zip(&setup.sigma) {
        *nominal += sigma * noise.one();
    }
    Record {
        configuration,
        samples: stream.iter().map(of_c).collect(),
    }
}

/// A sample with all measurements, as C has it.
fn of_c(sample: &poinsot_onboard::Sample) -> Sample {
    Sample {
        time_s: sample.time_s,
        gyro: sample.gyro.unwrap(),
        attitude: sample.attitude.unwrap(),
        position: sample.position.unwrap(),
        wheel_speed: sample.wheel_speed,
        joint_position: sample.joint_position,
        joint_rate: sample.joint_rate,
        force_B: sample.force_B,
        torque_B: sample.torque_B,
        measured: MEASURED_GYRO | MEASURED_ATTITUDE | MEASURED_POSITION,
        reserved: 0,
    }
}

/// The bytes of a sample in memory, little-endian.
fn bytes(sample: &Sample) -> Vec<u8> {
    let vectors = [
        &sample.gyro[..],
        &sample.attitude,
        &sample.position,
        &sample.wheel_speed,
        &sample.joint_position,
        &sample.joint_rate,
    ];
    let vectors = vectors
        .into_iter()
        .chain([&sample.force_B[..], &sample.torque_B]);
    let numbers = [sample.time_s]
        .into_iter()
        .chain(vectors.flatten().copied());
    let words = [sample.measured, sample.reserved].into_iter();
    let words = words.flat_map(u32::to_le_bytes);
    numbers.flat_map(f64::to_le_bytes).chain(words).collect()
}

/// `scripts/test board` names a folder in `POINSOT_BOARD`; there the example finds its table and its samples.
#[test]
fn unit_the_record_has_the_bytes_of_the_structs() {
    let record = record();
    let flight: Vec<u8> = record.samples.iter().flat_map(bytes).collect();
    assert_eq!(flight.len(), size_of::<Sample>() * record.samples.len());
    if let Ok(folder) = std::env::var("POINSOT_BOARD") {
        std::fs::write(
            format!("{folder}/filter.bin"),
            record.configuration.to_table(),
        )
        .unwrap();
        std::fs::write(format!("{folder}/flight.bin"), flight).unwrap();
    }
}
