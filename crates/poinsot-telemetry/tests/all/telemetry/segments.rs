//! Maps, filters and several files of one segment.

use crate::telemetry::{Folder, assert_told, map_of, read_text};
use poinsot_telemetry::{ColumnMap, ReadOptions, read};
use std::f64::consts::PI;
use std::sync::Arc;

#[test]
fn exact_mapped_columns_arrive_in_si() {
    let options = ReadOptions {
        map: map_of(
            vec![
                ColumnMap::new("time_s", "t_ms", "ms"),
                ColumnMap::new("omega_x", "wx [deg/s]", "deg/s"),
                ColumnMap::new("imu2.omega_x", "wx2", "rpm"),
            ],
            Vec::new(),
        ),
        ..ReadOptions::default()
    };
    let text =
        "\u{feff}t_ms,wx [deg/s],wx2,omega_x,Mode\r\n0,180,60,9,idle\r\n100,-90,30,9,safe\r\n";
    let table = read_text(text, &options).unwrap();
    let x = table.sensor_channel("", "omega_x").unwrap();
    assert_eq!(x.values, [PI, -PI / 2.0]);
    assert_eq!(x.time_s.as_ref(), [0.0, 0.1]);
    assert_eq!((x.unit.as_str(), x.frame.as_str()), ("rad/s", "body"));
    assert_eq!(
        table.sensor_channel("imu2", "omega_x").unwrap().values,
        [60.0 * (2.0 * PI) / 60.0, 30.0 * (2.0 * PI) / 60.0]
    );
    assert_eq!(
        table.ignored,
        ["omega_x", "Mode"],
        "the map stands before the name"
    );
    assert!(table.repairs.is_empty());
}

#[test]
fn unit_rows_are_chosen_before_times_are_checked() {
    let text = "run,time_s,omega_x\na,0,1\na,1,2\nb,0,3\nb,1,4\n";
    let options = |value: &str| ReadOptions {
        map: map_of(Vec::new(), vec![("run".into(), value.into())]),
        ..ReadOptions::default()
    };
    let table = read_text(text, &options("b")).unwrap();
    assert_eq!(table.channel("omega_x").unwrap().values, [3.0, 4.0]);
    assert_eq!(
        (table.sources[0].rows, table.sources[0].time_s),
        (4, [0.0, 1.0])
    );
    assert!(table.ignored.is_empty());
    let error = read_text(text, &options("c")).unwrap_err();
    assert_told(&error, "E0213 where run = 'c'", "'a', 'b'");
    let missing = ReadOptions {
        map: map_of(Vec::new(), vec![("runs".into(), "a".into())]),
        ..ReadOptions::default()
    };
    let text = "run,time_s,omega_x\na,0,1\na,1,2\n";
    let error = read_text(text, &missing).unwrap_err();
    assert_told(&error, "E0213 where runs = 'a'", "'run'");
}

#[test]
fn unit_only_what_is_asked_for_is_parsed() {
    let options = ReadOptions {
        wanted: Some(["omega_x".to_owned()].into()),
        ..ReadOptions::default()
    };
    let text = "time_s,omega_x,omega_y,imu2.omega_x\n0,1,broken,5\n1,2,broken,6\n";
    let table = read_text(text, &options).unwrap();
    assert_eq!(table.channels.len(), 2, "of any sensor");
    assert_eq!(table.ignored, ["omega_y"]);
}

#[test]
fn unit_files_of_a_segment_keep_their_time_bases() {
    let folder = Folder::new();
    let rates = folder.file(
        "rates.csv",
        "time_s,omega_x,omega_y\n0,1,2\n0.1,3,4\n0.2,5,6\n",
    );
    let wheels = folder.file("wheels.csv", "time_s,wheel1_rad_s\n0.05,100\n0.15,200\n");
    let table = read(&[&rates, &wheels], &ReadOptions::default()).unwrap();
    let [x, y, w] = table.channels.as_slice() else {
        panic!("{:?}", table.channels)
    };
    assert!(
        Arc::ptr_eq(&x.time_s, &y.time_s),
        "one array for columns without gaps"
    );
    assert_eq!(w.time_s.as_ref(), [0.05, 0.15]);
    assert_eq!(table.sources.len(), 2);
    let runs = folder.file("runs.csv", "run,time_s,omega_z\na,0,1\nb,0,2\nb,1,3\n");
    let filtered = ReadOptions {
        map: map_of(Vec::new(), vec![("run".into(), "b".into())]),
        ..ReadOptions::default()
    };
    let table = read(&[&runs, &wheels], &filtered).unwrap();
    assert_eq!(table.channel("omega_z").unwrap().values, [2.0, 3.0]);
    assert!(
        table.repairs[0]
            .ends_with("wheels.csv: no column 'run' to choose rows by; all its rows are kept")
    );
    let error = read(&[&rates, &rates], &ReadOptions::default()).unwrap_err();
    assert_eq!(error.code(), "E0210");
    let place = "rates.csv column 'omega_x'";
    assert_eq!(folder.message(&error).matches(place).count(), 2, "{error}");
}

#[test]
fn exact_the_hash_is_that_of_the_bytes() {
    let table = read_text("time_s,omega_x\n0,1\n1,2\n", &ReadOptions::default()).unwrap();
    // printf 'time_s,omega_x\n0,1\n1,2\n' | sha256sum
    assert_eq!(table.sources[0].sha256, HASH);
}

const HASH: &str = "0f5f323f49c74e848f5f064437f51b4e14274549cd67558eb56486d323c555eb";

#[test]
fn unit_columns_with_the_same_gaps_share_their_times() {
    let text = "time_s,omega_x,q_x,q_y,q_z,q_w\n0,1,0,0,0,1\n0.1,1,,,,\n0.2,1,,,,\n0.3,1,0,0,0,1\n";
    let table = read_text(text, &ReadOptions::default()).unwrap();
    let [q_x, q_w] = ["q_x", "q_w"].map(|n| table.channel(n).unwrap());
    assert_eq!(q_x.time_s.as_ref(), [0.0, 0.3]);
    assert!(Arc::ptr_eq(&q_x.time_s, &q_w.time_s));
    assert!(table.repairs.is_empty(), "{:?}", table.repairs);
}
