//! The functions: the numbers of the filter, and codes for what is wrong.

use crate::record::record;
use crate::setups;
use poinsot_onboard::{Configuration, Filter, JOINTS, TABLE, WHEELS};
use poinsot_onboard_c::*;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

/// Zeroed memory for a filter, as static memory of C.
fn memory() -> Box<MaybeUninit<Onboard>> {
    let mut memory = Box::<Onboard>::new_uninit();
    // SAFETY: memory of its own.
    unsafe { memory.as_mut_ptr().write_bytes(0, 1) };
    memory
}

fn init(filter: *mut Onboard, table: &[u8]) -> Code {
    // SAFETY: `filter` is null or memory of `SIZE` bytes.
    unsafe { poinsot_onboard_init(filter, size_of::<Onboard>(), table.as_ptr(), table.len()) }
}

fn read(filter: *mut Onboard, time_s: f64) -> (Code, Answer) {
    // SAFETY: all bits of an answer zero are one.
    let mut answer: Answer = unsafe { std::mem::zeroed() };
    // SAFETY: as in `init`.
    let code = unsafe { poinsot_onboard_read(filter, time_s, &mut answer) };
    (code, answer)
}

/// A filter of another size has the same bits, so both agree in every one.
#[test]
fn exact_numbers_are_those_of_the_filter() {
    let record = record();
    let mut own = Box::new(Filter::<48, WINDOW>::new(record.configuration).unwrap());
    let mut memory = memory();
    let filter = memory.as_mut_ptr();
    assert_eq!(init(filter, &record.configuration.to_table()), Code::Ok);
    let mut determined = 0;
    for sample in &record.samples {
        own.push(&(*sample).into()).unwrap();
        // SAFETY: `filter` has a filter.
        assert_eq!(unsafe { poinsot_onboard_push(filter, sample) }, Code::Ok);
        let (expected, (code, found)) = (own.answer(sample.time_s), read(filter, sample.time_s));
        assert_eq!(code, Code::Ok);
        assert_eq!(found.value, expected.numbers.map(|n| n.value));
        assert_eq!(found.sigma, expected.numbers.map(|n| n.sigma));
        assert_eq!(found.covariance, expected.covariance);
        assert_eq!(found.accepted, own.counts().map(|c| c.accepted));
        assert_eq!((found.health, found.unknowns), (expected.health as u32, 10));
        for (k, number) in expected.numbers.iter().enumerate() {
            assert_eq!(found.determined >> k & 1 == 1, number.determined);
        }
        determined = found.determined;
    }
    assert_eq!(determined, 0x3FF);
    // SAFETY: `filter` has a filter.
    assert_eq!(unsafe { poinsot_onboard_flush(filter) }, Code::Ok);
}

#[test]
fn unit_wrong_arguments_give_codes() {
    let record = record();
    let (table, sample) = (record.configuration.to_table(), &record.samples[0]);
    let mut memory = memory();
    let filter = memory.as_mut_ptr();
    assert_eq!(init(null_mut(), &table), Code::Null);
    let size = size_of::<Onboard>();
    // SAFETY: what is checked is that these pointers and sizes are refused.
    unsafe {
        assert_eq!(
            poinsot_onboard_init(filter, size, null(), TABLE),
            Code::Null
        );
        let short = poinsot_onboard_init(filter, size - 1, table.as_ptr(), TABLE);
        assert_eq!(short, Code::Memory);
        let odd = filter.byte_add(4);
        assert_eq!(
            poinsot_onboard_init(odd, size, table.as_ptr(), TABLE),
            Code::Memory
        );
        for code in [
            poinsot_onboard_push(filter, sample),
            poinsot_onboard_flush(filter),
            read(filter, 0.0).0,
        ] {
            assert_eq!(code, Code::NotInitialised);
        }
        assert_eq!(poinsot_onboard_push(odd, sample), Code::Memory);
        assert_eq!(poinsot_onboard_push(null_mut(), sample), Code::Null);
        assert_eq!(init(filter, &table), Code::Ok);
        assert_eq!(poinsot_onboard_push(filter, null()), Code::Null);
        assert_eq!(poinsot_onboard_read(filter, 0.0, null_mut()), Code::Null);
        assert_eq!(read(filter, f64::NAN).0, Code::NotFinite);
        let mut bad = *sample;
        bad.gyro[1] = f64::INFINITY;
        assert_eq!(poinsot_onboard_push(filter, &bad), Code::NotFinite);
        // What a sample has not is not read.
        bad.measured &= !MEASURED_GYRO;
        assert_eq!(poinsot_onboard_push(filter, &bad), Code::Ok);
        assert_eq!(poinsot_onboard_push(filter, sample), Code::Duplicate);
    }
    assert_eq!(poinsot_onboard_size(), size);
    assert_eq!(poinsot_onboard_version(), VERSION);
}

/// A table that is refused leaves no filter behind.
#[test]
fn unit_wrong_tables_give_codes() {
    let record = record();
    let mut memory = memory();
    let filter = memory.as_mut_ptr();
    let refused = |table: &[u8], code| {
        assert_eq!(init(filter, &record.configuration.to_table()), Code::Ok);
        assert_eq!(init(filter, table), code);
        assert_eq!(read(filter, 0.0).0, Code::NotInitialised);
    };
    let valid = record.configuration.to_table();
    refused(&valid[..TABLE - 1], Code::TableLength);
    for (at, code) in [
        (0, Code::TableMagic),
        (8, Code::TableVersion),
        (40, Code::TableChecksum),
    ] {
        let mut table = valid;
        table[at] ^= 1;
        refused(&table, code);
    }
    let changed = |change: fn(&mut Configuration)| {
        let mut configuration = record.configuration;
        change(&mut configuration);
        configuration.to_table()
    };
    refused(&changed(|c| c.nominal[0] = f64::NAN), Code::TableNotFinite);
    refused(&changed(|c| c.reorder = 5), Code::Count);
    refused(&changed(|c| c.noise.gyro = 0.0), Code::Noise);
    refused(
        &changed(|c| c.wheels[0].axis_B = [2.0, 0.0, 0.0]),
        Code::Axis,
    );
    refused(&changed(|c| c.prior[(3, 3)] = 0.0), Code::Prior);
    refused(&changed(|c| c.nominal[0] = -1.0), Code::Unphysical);
    refused(&changed(|c| c.noise.position = 0.0), Code::NeedsPosition);
}

/// The largest configuration there is fits, so no valid table is refused for its size.
#[test]
fn unit_every_valid_table_fits() {
    let mut configuration = record().configuration;
    let wheel = setups::tumbling().configuration.wheels[0];
    while configuration.wheel_count < WHEELS {
        configuration = configuration.with_wheel(wheel);
    }
    let joint = setups::arm_with_payload().configuration.joints[0];
    while configuration.joint_count < JOINTS {
        configuration = configuration.with_joint(joint);
    }
    configuration.noise.bias_walk = 1.0e-6;
    assert_eq!(
        init(memory().as_mut_ptr(), &configuration.to_table()),
        Code::Ok
    );
}
