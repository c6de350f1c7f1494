//! Bytes as the table of an on-board filter, and as changes of a vehicle and of the stream of its samples.

use arbitrary::{Result, Unstructured};
use nalgebra::UnitQuaternion;
use poinsot_onboard::{Answer, Configuration, Filter, Health, Mode, NUMBERS, Noise, Sample, Wheel};
use poinsot_spatial::{Matrix3, Vector3};

/// 6 s are replayed.
type OnBoard = Filter<64, 30>;

const SAMPLES: usize = 240;
/// Time between samples, s.
const DT_S: f64 = 0.2;
/// Steps of the motion from sample to sample.
const STEPS: usize = 4;
const SPIN_INERTIA: f64 = 2.0e-3;
/// Of gyro and attitude, rad/s and rad; of the wheels, rad/s.
const NOISE: f64 = 1.0e-4;
const WHEEL_NOISE: f64 = 0.01;
const EDGES: [f64; 6] = [0.0, -1.0, 5.0e-324, 1.0e9, f64::MAX, f64::NAN];

/// Any bytes as a table, then a bus with three wheels whose configuration and samples they change. Whatever is pushed, numbers that are
/// called determined are finite.
pub fn onboard(bytes: &[u8]) {
    if let Ok(read) = Configuration::from_table(bytes) {
        let _ = OnBoard::new(read);
    }
    let _ = changed_stream(&mut Unstructured::new(bytes));
}

/// The health at the end; `None` where the configuration is refused. Without bytes nothing is changed.
fn changed_stream(u: &mut Unstructured) -> Result<Option<Health>> {
    let mut configuration = bus();
    for _ in 0..u.int_in_range(0..=2)? {
        change_configuration(u, &mut configuration)?;
    }
    let Ok(mut filter) = OnBoard::new(configuration) else {
        return Ok(None);
    };
    let mut before = Sample::at(0.0);
    for mut sample in motion() {
        change_sample(u, &mut sample, &before)?;
        let _ = filter.push(&sample);
        check(&filter.answer(sample.time_s));
        before = sample;
    }
    filter.flush();
    let answer = filter.answer(before.time_s);
    check(&answer);
    Ok(Some(answer.health))
}

fn check(answer: &Answer) {
    let determined = answer.numbers.iter().filter(|n| n.determined);
    let finite = |n: &poinsot_onboard::Number| n.value.is_finite() && n.sigma.is_finite();
    assert!(determined.clone().all(finite), "{answer:?}");
    let mut all = answer.covariance.iter().flatten();
    let told = answer.health == Health::Determined;
    assert!(!told || all.all(|c| c.is_finite()), "{answer:?}");
}

/// The unchanged bus; its inertia tensor is unknown.
fn bus() -> Configuration {
    let noise = Noise {
        gyro: NOISE,
        attitude: NOISE,
        position: 0.0,
        bias: NOISE,
        bias_walk: 0.0,
        torque_walk: 0.0,
    };
    let I = inertia();
    let elements = [I.m11, I.m12, I.m22, I.m13, I.m23, I.m33];
    let mut nominal = [100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    nominal[4..].copy_from_slice(&elements);
    let mut configuration = Configuration::new(nominal, noise);
    for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
        configuration = configuration.with_wheel(Wheel {
            axis_B: axis.into(),
            spin_inertia: SPIN_INERTIA,
            noise: WHEEL_NOISE,
        });
    }
    configuration.uncertain[4..10].fill(true);
    for k in 0..6 {
        configuration.prior[(k, k)] = 0.5;
    }
    configuration
}

fn panel() -> Mode {
    Mode {
        frequency_Hz: 0.4,
        damping_ratio: 0.01,
        translation: Vector3::x() * 0.5,
        rotation: Vector3::new(0.0, 0.3, 0.2),
        ..Mode::default()
    }
}

/// About the mass centre, with the wheels as they stand, kg m2.
fn inertia() -> Matrix3 {
    Matrix3::new(10.0, 0.4, -0.3, 0.4, 12.0, 0.2, -0.3, 0.2, 8.0)
}

/// Measurements of that bus at constant momentum, while its wheels are driven; its nominal numbers are right.
fn motion() -> impl Iterator<Item = Sample> {
    let speeds = |k: usize| {
        let phase = 0.1 * k as f64;
        Vector3::new(phase.sin(), (0.7 * phase).cos() - 1.0, (0.4 * phase).sin()) * 60.0
    };
    let h_N = inertia() * Vector3::new(0.01, -0.02, 0.015);
    let rate = move |R: &UnitQuaternion<f64>, speeds: Vector3| {
        let own = R.inverse() * h_N - speeds * SPIN_INERTIA;
        inertia().try_inverse().unwrap_or_default() * own
    };
    let mut R = UnitQuaternion::identity();
    (0..SAMPLES).map(move |k| {
        let [from, to] = [k, k + 1].map(speeds);
        let mut sample = Sample::at(k as f64 * DT_S);
        let noise = |sensor: usize| Vector3::from_fn(|i, _| scatter(9 * k + 3 * sensor + i));
        let tilt = UnitQuaternion::from_scaled_axis(NOISE * noise(1));
        sample.gyro = Some((rate(&R, from) + NOISE * noise(0)).into());
        sample.attitude = Some((R * tilt).coords.into());
        sample.wheel_speed[..3].copy_from_slice((from + WHEEL_NOISE * noise(2)).as_slice());
        for step in 0..STEPS {
            let h = DT_S / STEPS as f64;
            let at = |share: f64| from + (to - from) * ((step as f64 + share) / STEPS as f64);
            let half = R * UnitQuaternion::from_scaled_axis(rate(&R, at(0.0)) * (0.5 * h));
            R *= UnitQuaternion::from_scaled_axis(rate(&half, at(0.5)) * h);
        }
        sample
    })
}

/// Of variance 1, and without a pattern that the filter could take for motion.
fn scatter(k: usize) -> f64 {
    let uniform = ((12.9898 * (k + 1) as f64).sin() * 43_758.545_3).rem_euclid(1.0);
    (uniform - 0.5) * 12.0_f64.sqrt()
}

fn change_configuration(u: &mut Unstructured, c: &mut Configuration) -> Result<()> {
    if u.arbitrary()? {
        *c = c.with_mode(panel());
    }
    let value = number(u)?;
    let body = c.known.iter_mut().chain(&mut c.nominal);
    let wheels = c.wheels.iter_mut().flat_map(|w| {
        let last = [&mut w.spin_inertia, &mut w.noise];
        w.axis_B.iter_mut().chain(last)
    });
    let n = &mut c.noise;
    let noise = [&mut n.gyro, &mut n.attitude, &mut n.position, &mut n.bias];
    let last = [
        &mut n.bias_walk,
        &mut n.torque_walk,
        &mut c.longest_gap_s,
        &mut c.stale_s,
        &mut c.forget_s,
    ];
    let modes = c.modes.iter_mut().flat_map(|m| {
        let first = [&mut m.frequency_Hz, &mut m.damping_ratio].into_iter();
        first.chain(&mut m.translation).chain(&mut m.rotation)
    });
    let all = body.chain(&mut c.prior.0).chain(wheels);
    let mut all: Vec<&mut f64> = all.chain(noise).chain(last).chain(modes).collect();
    *all.swap_remove(u.choose_index(all.len())?) = value;
    c.uncertain[u.choose_index(NUMBERS)?] ^= u.arbitrary::<bool>()?;
    c.reorder = u.int_in_range(0..=4)?;
    Ok(())
}

/// Leaves a sample as it is, or removes a sensor, repeats the previous sample, moves the time, or changes one number.
fn change_sample(u: &mut Unstructured, sample: &mut Sample, before: &Sample) -> Result<()> {
    match u.int_in_range(0..=15)? {
        11 => sample.gyro = None,
        12 => sample.attitude = None,
        13 => *sample = *before,
        14 => sample.time_s += number(u)?,
        15 => {
            let value = number(u)?;
            let measured = sample.gyro.iter_mut().flatten();
            let measured = measured.chain(sample.attitude.iter_mut().flatten());
            let acting = sample.force_B.iter_mut().chain(&mut sample.torque_B);
            let all = measured.chain(&mut sample.wheel_speed).chain(acting);
            let mut all: Vec<&mut f64> = all.collect();
            *all.swap_remove(u.choose_index(all.len())?) = value;
        }
        _ => {}
    }
    Ok(())
}

fn number(u: &mut Unstructured) -> Result<f64> {
    match u.arbitrary::<bool>()? {
        true => Ok(*u.choose(&EDGES)?),
        false => Ok(f64::from(u.arbitrary::<i16>()?) / 1000.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stream that bytes change is one that the filter can tell.
    #[test]
    fn prop_the_stream_as_it_is_determines_the_tensor() {
        let health = changed_stream(&mut Unstructured::new(&[]));
        assert_eq!(health, Ok(Some(Health::Determined)));
    }
}
