//! Written channels read back bit by bit.

use crate::telemetry::Folder;
use poinsot_telemetry::{Channel, ReadOptions, parse_unit, read, write};
use proptest::prelude::*;
use sha2::{Digest, Sha256};
use std::sync::Arc;

fn channel(sensor: &str, name: &str, time_s: &[f64], values: &[f64]) -> Channel {
    Channel {
        name: name.into(),
        sensor: sensor.into(),
        unit: "rad/s".into(),
        frame: "body".into(),
        time_s: time_s.into(),
        values: values.to_vec(),
    }
}

fn finite() -> impl Strategy<Value = f64> {
    any::<u64>()
        .prop_map(f64::from_bits)
        .prop_filter("finite", |x| x.is_finite())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn prop_any_doubles_survive_csv_and_parquet(
        x in prop::collection::vec(finite(), 5),
        y in prop::collection::vec(finite(), 3),
    ) {
        let folder = Folder::new();
        let fast: Arc<[f64]> = [0.0, 0.1, 0.2, 0.3, 0.1 + 0.3].as_slice().into();
        let mut channels = vec![channel("", "omega_x", &fast, &x)];
        channels.push(channel("imu2", "omega_y", &[0.05, 0.1, 7.0 / 3.0], &y));
        for name in ["a.csv", "a.parquet"] {
            let path = folder.path(name);
            write(&path, &channels).unwrap();
            let table = read(&[&path], &ReadOptions::default()).unwrap();
            prop_assert_eq!(&table.channels.len(), &2);
            for (back, sent) in table.channels.iter().zip(&channels) {
                prop_assert_eq!(back, sent);
                let bits = |c: &Channel| c.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                prop_assert_eq!(bits(back), bits(sent));
            }
            prop_assert!(table.repairs.is_empty());
        }
    }
}

/// Files from 4 MiB are hashed on a second thread.
#[test]
fn exact_a_long_file_has_the_hash_of_its_bytes() {
    let folder = Folder::new();
    let time_s: Vec<f64> = (0..400_000).map(|k| f64::from(k) * 0.1).collect();
    let values: Vec<f64> = time_s.iter().map(|t| t.sin()).collect();
    let channels = [channel("", "omega_x", &time_s, &values)];
    for name in ["a.csv", "a.parquet"] {
        let path = folder.path(name);
        write(&path, &channels).unwrap();
        let table = read(&[&path], &ReadOptions::default()).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert!(bytes.len() > 5 << 20, "{name}: {} bytes", bytes.len());
        let digest = Sha256::digest(&bytes);
        let digest: String = digest.iter().map(|b| format!("{b:02x}")).collect();
        assert_eq!(table.sources[0].sha256, digest, "{name}");
        assert_eq!(table.channels, channels, "{name}");
    }
}

#[test]
fn unit_nothing_appears_under_the_name_when_writing_fails() {
    let folder = Folder::new();
    let path = folder.path("a.csv");
    let twice = [0, 1].map(|_| channel("", "omega_x", &[0.0, 1.0], &[1.0, 2.0]));
    let nan = [channel("", "omega_x", &[0.0, 1.0], &[1.0, f64::NAN])];
    let back = [channel("", "omega_x", &[1.0, 0.0], &[1.0, 2.0])];
    for (channels, message) in [
        (
            twice.as_slice(),
            "E0219 a.csv column 'omega_x': two columns of this name; rename one channel",
        ),
        (
            &nan,
            "E0219 a.csv column 'omega_x': a value is not finite; correct what it comes from, or leave the sample out",
        ),
        (
            &back,
            "E0219 a.csv column 'omega_x': the times are not strictly increasing numbers; sort them and leave out what repeats",
        ),
    ] {
        let error = write(&path, channels).unwrap_err();
        assert_eq!(folder.message(&error), message);
    }
    // A file in place of a folder.
    std::fs::write(folder.path("file"), "").unwrap();
    let error = write(&folder.path("file/a.csv"), &nan[..0]).unwrap_err();
    assert_eq!(error.code(), "E0201");
    assert_eq!(std::fs::read_dir(folder.0.path()).unwrap().count(), 1);
}

#[test]
fn exact_a_written_file_reads_as_any_program_expects() {
    let folder = Folder::new();
    let path = folder.path("a.csv");
    let channels = [
        channel("", "omega_x", &[0.0, 0.1], &[1.0, -1e-7]),
        channel("gyro", "omega_y", &[0.1], &[1e22]),
    ];
    write(&path, &channels).unwrap();
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "time_s,omega_x,gyro.omega_y\n0.0,1.0,\n0.1,-1e-7,1e22\n"
    );
    assert_eq!(parse_unit("rad/s").unwrap().symbol, "rad/s");
}
