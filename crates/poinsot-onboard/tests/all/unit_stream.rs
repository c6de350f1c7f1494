//! Samples that are refused, late or out of order; memory.

use crate::setups::{self, OnBoard};
use crate::truth::{Noise, samples};
use poinsot_onboard::{Health, Invalid, Refusal, Sample};

fn stream() -> (Box<OnBoard>, Vec<Sample>) {
    let setup = setups::bus_with_wheels();
    let mut noise = Noise::new(3);
    let motions = setup.truth.motions(&setup.configuration);
    let stream = samples(
        &setup.truth,
        &setup.configuration,
        &motions,
        Some(&mut noise),
    );
    (setup.filter(&mut noise), stream)
}

#[test]
fn unit_bad_samples_are_refused_with_a_code() {
    let (mut filter, stream) = stream();
    filter.push(&stream[0]).unwrap();
    let mut bad = stream[1];
    bad.wheel_speed[2] = f64::NAN;
    assert_eq!(filter.push(&bad), Err(Refusal::NotFinite));
    // A wheel that the vehicle has not does not count.
    bad = stream[1];
    bad.wheel_speed[7] = f64::NAN;
    filter.push(&bad).unwrap();
    assert_eq!(filter.push(&stream[1]), Err(Refusal::Duplicate));
    assert_eq!(filter.push(&stream[0]), Err(Refusal::Late));
    bad = stream[2];
    bad.attitude = bad.attitude.map(|q| q.map(|x| 1.01 * x));
    assert_eq!(filter.push(&bad), Err(Refusal::Quaternion));
    bad = stream[2];
    bad.time_s = 1.0e6;
    assert_eq!(filter.push(&bad), Err(Refusal::ClockJump));
    filter.push(&stream[2]).unwrap();
}

#[test]
fn unit_a_new_clock_is_taken_after_three_samples() {
    let (mut filter, stream) = stream();
    for sample in &stream[..300] {
        filter.push(sample).unwrap();
    }
    let before = filter.answer(stream[299].time_s);
    let mut refused = 0;
    for sample in &stream[300..] {
        let mut shifted = *sample;
        shifted.time_s -= 1000.0;
        refused += u32::from(filter.push(&shifted).is_err());
    }
    let after = filter.answer(stream[599].time_s - 1000.0);
    assert_eq!((refused, after.health), (2, Health::Determined));
    assert!(after.numbers[4].sigma < before.numbers[4].sigma);
}

/// Samples that come in another order within the number that are held back give the same bits.
#[test]
fn exact_samples_out_of_order_are_put_in_order() {
    let setup = setups::bus_with_wheels();
    let (_, stream) = stream();
    let answer = |swap: bool| {
        let mut configuration = setup.configuration;
        configuration.reorder = 2;
        let mut filter = Box::new(OnBoard::new(configuration).unwrap());
        for four in stream.chunks(4) {
            let order = if swap { [2, 0, 1, 3] } else { [0, 1, 2, 3] };
            order.iter().for_each(|k| filter.push(&four[*k]).unwrap());
        }
        filter.flush();
        filter.answer(120.0)
    };
    assert_eq!(answer(true), answer(false));
}

#[test]
fn unit_old_answers_are_stale() {
    let (mut filter, stream) = stream();
    for sample in &stream {
        filter.push(sample).unwrap();
    }
    let end = stream[599].time_s;
    assert_eq!(filter.answer(end + 9.0).health, Health::Determined);
    assert_eq!(filter.answer(end + 11.0).health, Health::Stale);
}

/// Without a vehicle samples are taken or refused, and no number is determined.
#[test]
fn unit_an_idle_filter_has_no_numbers() {
    let (_, stream) = stream();
    let mut filter = Box::new(OnBoard::IDLE);
    for sample in &stream {
        let _ = filter.push(sample);
        let answer = filter.answer(sample.time_s);
        assert_eq!(answer.health, Health::Inconsistent);
        assert!(answer.numbers.iter().all(|n| !n.determined));
    }
}

/// A refused configuration changes nothing; a valid one leaves nothing of the samples before.
#[test]
fn exact_a_restarted_filter_is_a_new_one() {
    let configuration = setups::bus_with_wheels().configuration;
    let (_, stream) = stream();
    let run = |mut filter: Box<OnBoard>| {
        for sample in &stream {
            filter.push(sample).unwrap();
        }
        filter
    };
    let first = run(Box::new(OnBoard::new(configuration).unwrap()));
    let mut again = run(Box::new(
        OnBoard::new(setups::tumbling().configuration).unwrap(),
    ));
    let before = again.answer(0.0);
    let mut invalid = configuration;
    invalid.noise.gyro = 0.0;
    assert_eq!(again.restart(&invalid), Err(Invalid::Noise));
    assert_eq!(again.answer(0.0), before);
    again.restart(&configuration).unwrap();
    let again = run(again);
    assert_eq!(again.answer(120.0), first.answer(120.0));
    assert_eq!(again.counts(), first.counts());
}

#[test]
fn unit_invalid_configurations_are_refused() {
    let valid = setups::bus_with_thrusters().configuration;
    assert_eq!(valid.check(48), Ok(()));
    assert_eq!(valid.check(30), Err(Invalid::Capacity(32)));
    let mut bad = valid;
    bad.noise.position = 0.0;
    assert_eq!(bad.check(48), Err(Invalid::NeedsPosition));
    bad = valid;
    bad.nominal[9] = -1.0;
    assert_eq!(bad.check(48), Err(Invalid::Unphysical));
    bad = valid;
    bad.noise.gyro = f64::NAN;
    assert_eq!(bad.check(48), Err(Invalid::NotFinite));
    bad = valid;
    bad.wheel_count = 9;
    assert_eq!(bad.check(48), Err(Invalid::Count));
}

/// Neither a step nor the replay of the window allocates.
#[test]
fn unit_no_sample_allocates() {
    let (mut filter, stream) = stream();
    println!(
        "{} bytes with 64 columns and a window of 150 samples",
        size_of::<OnBoard>()
    );
    let info = allocation_counter::measure(|| {
        for sample in &stream {
            let _ = filter.push(sample);
            let _ = filter.answer(sample.time_s);
        }
    });
    assert_eq!(info.count_total, 0);
}
