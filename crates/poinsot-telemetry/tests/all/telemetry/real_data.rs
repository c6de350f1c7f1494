//! Files of real and simulated spacecraft that are not in the repository; they run by `scripts/test data`.

use crate::telemetry::map_of;
use poinsot_telemetry::{ColumnMap, ReadOptions, Verdict, convention_tests, inspect, read, write};
use poinsot_testkit::outside::outside;

fn map(lines: &[(&str, &str, &str)]) -> Vec<ColumnMap> {
    let map = |&(channel, column, unit): &(&str, &str, &str)| ColumnMap::new(channel, column, unit);
    lines.iter().map(map).collect()
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_a_throw_is_read_as_pyarrow_reads_it() {
    let path = outside("data/real/tudelft_throw/throws.parquet");
    let options = ReadOptions {
        map: map_of(
            map(&[
                ("time_s", "t_s", "s"),
                ("omega_x", "wx", "rad/s"),
                ("omega_y", "wy", "rad/s"),
                ("omega_z", "wz", "rad/s"),
                ("wheel_rad_s", "wheel_z", "rad/s"),
            ]),
            vec![("log".into(), "LOG00119".into())],
        ),
        ..ReadOptions::default()
    };
    let table = read(&[&path], &options).unwrap();
    let x = table.channel("omega_x").unwrap();
    // pyarrow: filter log == LOG00119, then float64 sums.
    assert_eq!(x.values.len(), 3152);
    assert_eq!(
        [x.time_s[0], x.time_s[x.time_s.len() - 1]],
        [-0.198068, 0.582072]
    );
    assert_eq!(table.sources[0].rows, 98_189);
    for (name, sum) in [
        ("omega_x", 9318.53380741924),
        ("omega_z", 17352.311843881384),
        ("wheel_rad_s", -1355833.5961341858),
    ] {
        let found: f64 = table.channel(name).unwrap().values.iter().sum();
        assert!((found - sum).abs() < 1e-9 * sum.abs(), "{name}: {found}");
    }
    assert_eq!(table.ignored, ["group", "ax", "ay", "az"]);
    let unfiltered = ReadOptions {
        map: map_of(options.map.all.columns, Vec::new()),
        ..ReadOptions::default()
    };
    assert_eq!(read(&[&path], &unfiltered).unwrap_err().code(), "E0208");
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_two_files_of_a_satellite_in_orbit() {
    let rates = outside("data/real/lomonosov_flight_wheels/attitude_rates.csv");
    let wheels = outside("data/real/lomonosov_flight_wheels/wheels.csv");
    let options = ReadOptions {
        map: map_of(
            map(&[
                ("time_s", "OBTS, sec", "s"),
                ("omega_x", "rRoll_meas", "deg/s"),
                ("wheel1_rad_s", "MRW1_meas", "rad/s"),
            ]),
            Vec::new(),
        ),
        ..ReadOptions::default()
    };
    let table = read(&[rates, wheels], &options).unwrap();
    let seen = inspect(&table);
    assert_eq!(seen.channels.len(), 2);
    assert!((seen.channels[0].rate_hz.unwrap() - 0.1).abs() < 1e-12);
    assert!(table.channels[0].time_s[0] + 4.0 == table.channels[1].time_s[0]);
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_simulated_telemetry_has_the_declared_conventions() {
    for run in ["stsat3/multiaxis", "xu2017/C1", "xu2017/C4", "ma2008/traj1"] {
        for name in ["telemetry.parquet", "telemetry_noisy.csv"] {
            let path = outside(&format!("data/ours/{run}/{name}"));
            let table = read(&[path], &ReadOptions::default()).unwrap();
            let tests = convention_tests(&table);
            let test = &tests[0];
            assert!(!test.is_contradicted(), "{run}/{name}: {test}");
            let decided = test.verdict == Verdict::DeclaredFits;
            println!("{run}/{name}: {} {}", decided, test.readings[0].residual);
            assert_eq!(tests.len(), 1);
        }
    }
}

#[test]
#[ignore = "needs POINSOT_DATA"]
fn xval_a_table_survives_being_written_again() {
    let path = outside("data/ours/xu2017/C1/telemetry.parquet");
    let table = read(&[path], &ReadOptions::default()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["again.csv", "again.parquet"] {
        let path = folder.path().join(name);
        write(&path, &table.channels).unwrap();
        let again = read(&[path], &ReadOptions::default()).unwrap();
        assert_eq!(again.channels, table.channels);
    }
}
