//! The byte table.

use crate::setups::{self, OnBoard};
use poinsot_onboard::{Configuration, TABLE, TableError};

/// Every byte, changed in every way that one bit or all bits can: refused.
#[test]
fn prop_a_changed_byte_is_refused() {
    for setup in setups::all() {
        let table = setup.configuration.to_table();
        assert_eq!(Configuration::from_table(&table), Ok(setup.configuration));
        for at in 0..TABLE {
            for change in [1, 2, 4, 8, 16, 32, 64, 128, 255] {
                let mut changed = table;
                changed[at] ^= change;
                assert!(
                    Configuration::from_table(&changed).is_err(),
                    "{at} {change}"
                );
            }
        }
        for length in [0, 1, TABLE - 1] {
            let short = Configuration::from_table(&table[..length]);
            assert_eq!(short, Err(TableError::Length));
        }
    }
}

proptest::proptest! {
    /// Any numbers behind a valid checksum make a filter that does not panic, or none.
    #[test]
    fn prop_any_numbers_make_a_filter_or_none(at in 0_usize..794, x: f64, other in 0_usize..794, y: f64) {
        let mut configuration = setups::bus_with_wheels().drawn().configuration;
        {
            let c = &mut configuration;
            let numbers = c.known.iter_mut().chain(&mut c.nominal).chain(&mut c.prior.0);
            let wheels = c.wheels.iter_mut();
            let wheels = wheels.flat_map(|w| w.axis_B.iter_mut().chain([&mut w.spin_inertia, &mut w.noise]));
            let noise = [&mut c.noise.gyro, &mut c.noise.attitude, &mut c.noise.position, &mut c.noise.bias];
            for (k, number) in numbers.chain(wheels).chain(noise).enumerate() {
                if k == at { *number = x; }
                if k == other { *number = y; }
            }
        }
        if let Ok(read) = Configuration::from_table(&configuration.to_table()) {
            proptest::prop_assert_eq!(read, configuration);
            if let Ok(filter) = OnBoard::new(read) {
                let answer = filter.answer(0.0);
                proptest::prop_assert!(answer.numbers.iter().all(|n| !n.determined));
            }
        }
    }
}
