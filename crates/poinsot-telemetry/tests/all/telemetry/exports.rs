//! Files exported by ground stations: layout, times, units row, compression.

use crate::telemetry::{Folder, assert_told, map_of, read_text};
use poinsot_telemetry::{
    AttitudeColumn, AttitudeMap, ColumnMap, FileMap, Layout, NamedMap, OrbitFrame, OrbitMap, Order,
    Overlap, ReadOptions, Scale, Sense, TelemetryMap, TimeFormat, TimeMap, read,
};
use std::f64::consts::PI;
use std::io::Write;

pub(super) fn of(all: FileMap) -> ReadOptions {
    ReadOptions {
        map: TelemetryMap {
            all,
            ..TelemetryMap::default()
        },
        ..ReadOptions::default()
    }
}

pub(super) fn named(columns: &[&str]) -> Option<Vec<AttitudeColumn>> {
    let name = |column: &&str| AttitudeColumn::Name((*column).to_owned());
    Some(columns.iter().map(name).collect())
}

pub(super) fn iso(column: &str) -> Option<TimeMap> {
    Some(TimeMap {
        column: column.to_owned(),
        format: TimeFormat::Iso8601,
        ..TimeMap::default()
    })
}

#[test]
fn exact_layout_units_row_and_dates() {
    let text = "Export 4\n\"unbalanced\n# spacecraft\nUTC;wx;RW1\n-;[deg/s];rpm\n# cut\n\
                2026-03-14T18:19:00.5Z;180;60\n2026-03-14T18:19:00.7Z;-90;30\n";
    let options = of(FileMap {
        layout: Layout {
            delimiter: Some(";".to_owned()),
            comment: Some("#".to_owned()),
            header_row: Some(4),
            units_row: Some(true),
            ..Layout::default()
        },
        time: iso("UTC"),
        columns: vec![
            ColumnMap {
                unit: None,
                sign: Some(-1.0),
                ..ColumnMap::new("omega_x", "wx", "")
            },
            ColumnMap::new("wheel1_rad_s", "RW1", "rpm"),
        ],
        ..FileMap::default()
    });
    let table = read_text(text, &options).unwrap();
    let x = table.channel("omega_x").unwrap();
    assert_eq!(x.values, [-PI, PI / 2.0]);
    assert_eq!(x.time_s.as_ref(), [0.0, 0.2]);
    let turn = table.channel("wheel1_rad_s").unwrap().values[0];
    assert!(
        (turn / (2.0 * PI) - 1.0).abs() < 4.0 * f64::EPSILON,
        "{turn}"
    );
    let date = table.origin.and_then(|o| o.date());
    assert_eq!(date.as_deref(), Some("2026-03-14T18:19:00.5 UTC"));
    // Lines are counted from the start of the file, not from the header.
    let broken = text.replace("-90", "x");
    assert!(
        read_text(broken, &options)
            .unwrap_err()
            .starts_with("E0203 run.csv:8 column 'wx': 'x' is not a number")
    );
}

#[test]
fn exact_files_with_clocks_of_their_own_share_one_origin() {
    let folder = Folder::new();
    let gyro = folder.file("gyro.csv", "t,omega_x\n1773512340.0,1\n1773512340.2,2\n");
    let tracker = folder.file(
        "tracker.csv",
        "TAI,s1,s2,s3\n2026-03-14T18:19:37.100,0,0,0\n2026-03-14T18:19:37.300,0,0,0.41421356237309503\n",
    );
    let mut options = of(FileMap {
        time: Some(TimeMap {
            column: "t".into(),
            epoch: Some("unix".into()),
            ..TimeMap::default()
        }),
        ..FileMap::default()
    });
    let own = FileMap {
        time: Some(TimeMap {
            scale: Some(Scale::Tai),
            ..iso("TAI").unwrap()
        }),
        attitude: vec![AttitudeMap {
            mrp: named(&["s1", "s2", "s3"]),
            sense: Some(Sense::InertialToBody),
            ..AttitudeMap::default()
        }],
        ..FileMap::default()
    };
    options.map.files = vec![NamedMap {
        name: "tracker*".to_owned(),
        map: own,
    }];
    let table = read(&[&gyro, &tracker], &options).unwrap();
    assert_eq!(*table.channel("q_z").unwrap().time_s, [0.1, 0.3]);
    // tan(90 deg / 4), inverted: a rotation by -90 deg about z.
    let z = table.channel("q_z").unwrap().values[1];
    assert!((z + (PI / 4.0).sin()).abs() < 1e-15, "{z}");
    let unused = ReadOptions {
        map: TelemetryMap {
            files: vec![NamedMap {
                name: "pulses*".to_owned(),
                ..NamedMap::default()
            }],
            ..options.map.clone()
        },
        ..options.clone()
    };
    let told = read(&[&gyro], &unused).unwrap().repairs.join("\n");
    assert!(told.contains("no file is named 'pulses*'"), "{told}");
}

#[test]
fn exact_positions_in_axes_of_the_earth() {
    // The Earth rotation angle of 2007 October 15, 0 h, is 0.4022837240028158 rad (SOFA, iauEra00).
    let text = "UTC,x,y,z\n2007-10-15T00:00:00,7000,0,100\n2007-10-15T00:00:10,7000,0,100\n";
    let options = of(FileMap {
        time: iso("UTC"),
        orbit: Some(OrbitMap {
            velocity: None,
            velocity_unit: None,
            position: ["x", "y", "z"].map(str::to_owned),
            unit: Some("km".into()),
            frame: Some(OrbitFrame::EarthFixed),
        }),
        ..FileMap::default()
    });
    let table = read_text(text, &options).unwrap();
    let at = |name: &str| table.channel(name).unwrap().values[0];
    let angle = 0.402_283_724_002_815_8_f64;
    assert!((at("orbit_x") - 7.0e6 * angle.cos()).abs() < 0.02);
    assert!((at("orbit_y") - 7.0e6 * angle.sin()).abs() < 0.02);
    assert_eq!(at("orbit_z"), 1.0e5);
}

/// The velocity relative to Earth-fixed axes is the derivative of the Earth-fixed position. For a circular orbit in
/// closed form it must convert back to the inertial velocity.
#[test]
fn exact_velocities_in_axes_of_the_earth() {
    let (radius, inclination, motion) = (7.0e6_f64, 1.7_f64, 1.078e-3_f64);
    // Earth rotation angle at 0 h and its rate: IERS Conventions 2010, eq. 5.15.
    let rate = 2.0 * PI * 1.002_737_811_911_354_5 / 86_400.0;
    let era = |t: f64| 0.402_283_724_002_815_8 + rate * t;
    let (si, ci) = inclination.sin_cos();
    let inertial = |t: f64| {
        let (s, c) = (motion * t + 0.4).sin_cos();
        let r = [c, ci * s, si * s].map(|x| radius * x);
        (r, [-s, ci * c, si * c].map(|x| radius * motion * x))
    };
    let fixed = |t: f64| {
        let ([x, y, z], (s, c)) = (inertial(t).0, era(t).sin_cos());
        [c * x + s * y, c * y - s * x, z]
    };
    let mut text = "UTC,x,y,z,u,v,w\n".to_owned();
    for (second, t) in [("00", 0.0), ("10", 10.0), ("20", 20.0)] {
        let (h, at) = (0.05, fixed(t));
        let (after, before) = (fixed(t + h), fixed(t - h));
        text.push_str(&format!("2007-10-15T00:00:{second}"));
        at.iter()
            .for_each(|x| text.push_str(&format!(",{}", x / 1e3)));
        for k in 0..3 {
            text.push_str(&format!(",{}", (after[k] - before[k]) / (2.0 * h) / 1e3));
        }
        text.push('\n');
    }
    let options = of(FileMap {
        time: iso("UTC"),
        orbit: Some(OrbitMap {
            position: ["x", "y", "z"].map(str::to_owned),
            unit: Some("km".into()),
            velocity: Some(["u", "v", "w"].map(str::to_owned)),
            velocity_unit: Some("km/s".into()),
            frame: Some(OrbitFrame::EarthFixed),
        }),
        ..FileMap::default()
    });
    let table = read_text(&text, &options).unwrap();
    for (k, name) in ["v_x", "v_y", "v_z"].into_iter().enumerate() {
        let values = &table.channel(name).unwrap().values;
        for (row, value) in values.iter().enumerate() {
            let wanted = inertial(10.0 * row as f64).1[k];
            // Differences over 0.1 s have errors of 4e-6 m/s, the date 2e-5 s times the acceleration; the axes move
            // with 500 m/s.
            assert!(
                (value - wanted).abs() < 1.0e-3,
                "{name}: {value}, not {wanted}"
            );
        }
    }
}

#[test]
fn exact_packed_files_hold_what_the_plain_file_holds() {
    let folder = Folder::new();
    let rows: String = (0..2000)
        .map(|k| format!("{k},{}\n", 0.1 * f64::from(k)))
        .collect();
    let text = format!("time_s,omega_x\n{rows}");
    let plain = folder.file("run.csv", &text);
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    gzip.write_all(text.as_bytes()).unwrap();
    let gzip = gzip.finish().unwrap();
    let wanted = read(&[&plain], &ReadOptions::default()).unwrap();
    let zstd = zstd::encode_all(text.as_bytes(), 3).unwrap();
    for (name, bytes) in [("run.csv.gz", gzip.clone()), ("run.csv.zst", zstd)] {
        let path = folder.file(name, bytes);
        let table = read(&[&path], &ReadOptions::default()).unwrap();
        assert_eq!(table.channels, wanted.channels, "{name}");
        assert_ne!(table.sources[0].sha256, wanted.sources[0].sha256);
    }
    let cut = folder.file("cut.csv.gz", &gzip[..gzip.len() / 2]);
    let error = read(&[&cut], &ReadOptions::default()).unwrap_err();
    assert!(
        folder
            .message(&error)
            .starts_with("E0202 cut.csv.gz: the packed data are damaged"),
        "{error}"
    );
}

#[test]
fn exact_pulse_tables_hold_the_nominal_force_for_their_duration() {
    let text = "time_s,ON1,ON2\n0,0,\n1,250,\n2,,\n3,1500,\n4,1000,\n";
    let pulse = |channel: &str, column: &str| ColumnMap {
        nominal_N: Some(0.9),
        overlap: Some(Overlap::Merged),
        ..ColumnMap::new(channel, column, "ms")
    };
    let options = of(FileMap {
        columns: vec![pulse("thr1_N", "ON1"), pulse("thr2_N", "ON2")],
        ..FileMap::default()
    });
    let table = read_text(text, &options).unwrap();
    let thrust = table.channel("thr1_N").unwrap();
    // The pulse of 4 s starts before the end of the pulse of 3 s.
    assert_eq!(thrust.time_s.as_ref(), [1.0, 1.25, 3.0, 5.0]);
    assert_eq!(thrust.values, [0.9, 0.0, 0.9, 0.0]);
    let off = table.channel("thr2_N").unwrap();
    assert_eq!(
        (off.time_s.as_ref(), off.values.as_slice()),
        (&[0.0][..], &[0.0][..])
    );
    let negative = read_text("time_s,ON1,ON2\n0,-1,\n1,0,\n", &options).unwrap_err();
    let said = negative.to_string();
    assert!(
        said.contains(":2 column 'ON1'") && said.contains("a negative duration"),
        "{said}"
    );
}

/// One table of pulses for all thrusters, two of them at one time, and one column for several channels.
#[test]
fn exact_a_column_that_names_the_channel_chooses_its_rows() {
    let text = "time_s,DURATION,THRUSTER\n1,250,A\n1,500,B\n3,1500,A\n";
    let of_thruster = |channel: &str, name: &str| ColumnMap {
        nominal_N: Some(0.9),
        rows: vec![("THRUSTER".to_owned(), name.to_owned())],
        ..ColumnMap::new(channel, "DURATION", "ms")
    };
    let map = |columns| {
        of(FileMap {
            columns,
            ..FileMap::default()
        })
    };
    let options = map(vec![
        of_thruster("thr1_N", "A"),
        of_thruster("thr2_N", "B"),
        of_thruster("thr3_N", "C"),
    ]);
    let table = read_text(text, &options).unwrap();
    let pulses = |name: &str| {
        let thrust = table.channel(name).unwrap();
        (thrust.time_s.to_vec(), thrust.values.clone())
    };
    let first = (vec![1.0, 1.25, 3.0, 4.5], vec![0.9, 0.0, 0.9, 0.0]);
    assert_eq!(pulses("thr1_N"), first);
    assert_eq!(pulses("thr2_N"), (vec![1.0, 1.5], vec![0.9, 0.0]));
    assert!(table.channel("thr3_N").is_none() && table.ignored.is_empty());
    let said = table.repairs.join("\n");
    assert!(
        said.contains("no row has 'C' in 'THRUSTER', so there is no thr3_N; the first values there are 'A', 'B'"),
        "{said}"
    );
    assert_eq!((table.sources.len(), table.sources[0].rows), (1, 3));
    let long = "time_s,NAME,VALUE\n0,GYR_X,1\n0,GYR_Y,2\n0.1,GYR_X,3\n0.1,GYR_Y,4\n";
    let rate = |channel: &str, name: &str| ColumnMap {
        rows: vec![("NAME".to_owned(), name.to_owned())],
        ..ColumnMap::new(channel, "VALUE", "mrad/s")
    };
    let options = map(vec![rate("omega_x", "GYR_X"), rate("omega_y", "GYR_Y")]);
    let table = read_text(long, &options).unwrap();
    for (name, values) in [("omega_x", [1e-3, 3e-3]), ("omega_y", [2e-3, 4e-3])] {
        let channel = table.channel(name).unwrap();
        assert_eq!(
            (channel.values.as_slice(), channel.time_s.as_ref()),
            (&values[..], &[0.0, 0.1][..])
        );
    }
    let wrong = map(vec![ColumnMap {
        nominal_N: Some(0.9),
        rows: vec![("THRUSTR".to_owned(), "A".to_owned())],
        ..ColumnMap::new("thr1_N", "DURATION", "ms")
    }]);
    let said = read_text(text, &wrong).unwrap_err().to_string();
    assert!(
        said.contains("THRUSTR") && said.contains("THRUSTER"),
        "{said}"
    );
}

#[test]
fn exact_bytes_and_streams_are_the_table_of_the_same_file() {
    let folder = Folder::new();
    let text = "time_s,omega_x,omega_y\n0.1,0.3,1\n0.2,,2\n0.3,0.1,3\n";
    let path = folder.file("rates.csv", text);
    let options = ReadOptions::default();
    let file = read(&[&path], &options).unwrap();
    let part = poinsot_telemetry::Part::bytes("rates.csv", text.into());
    // A stream can be read several times.
    for _ in 0..2 {
        let table = poinsot_telemetry::read_parts(std::slice::from_ref(&part), &options).unwrap();
        assert_eq!(table.channels, file.channels);
        assert_eq!(table.sources[0].sha256, file.sources[0].sha256);
    }
    let mut packed = Vec::new();
    let mut gz = flate2::write::GzEncoder::new(&mut packed, flate2::Compression::default());
    gz.write_all(text.as_bytes()).unwrap();
    gz.finish().unwrap();
    let part = poinsot_telemetry::Part::stream("downlink", &mut packed.as_slice()).unwrap();
    let table = poinsot_telemetry::read_parts(&[part], &options).unwrap();
    assert_eq!(table.channels, file.channels);
}

#[test]
fn unit_scattered_losses_are_counted_and_noise_is_proposed() {
    let mut text = "time_s,omega_x\n".to_owned();
    // Every tenth row is lost, and once five consecutive rows.
    for k in (0..200).filter(|k| k % 10 != 9 && !(100..105).contains(k)) {
        text.push_str(&format!(
            "{},{}\n",
            f64::from(k) * 0.5,
            (f64::from(k) * 7.7).sin()
        ));
    }
    let table = read_text(&text, &ReadOptions::default()).unwrap();
    let found = poinsot_telemetry::inspect(&table);
    // The last row is lost at the end and cannot be detected.
    assert_eq!((found.channels[0].lost, found.channels[0].gaps), (24, 1));
}

/// A camera's attitude comes in every form of a tracker's, under names of its own.
#[test]
fn exact_a_relative_attitude_has_every_form() {
    let text = "t,w,x,y,z,p1,p2,p3\n0,1,0,0,0,0,0,0\n0.1,0.6,0,0,-0.8,0,0,-0.5\n";
    let options = of(FileMap {
        time: Some(TimeMap {
            column: "t".into(),
            ..TimeMap::default()
        }),
        attitude: vec![
            AttitudeMap {
                sensor: "back".to_owned(),
                quaternion: named(&["w", "x", "y", "z"]),
                order: Some(Order::Wxyz),
                sense: Some(Sense::InertialToBody),
                relative: true,
                ..AttitudeMap::default()
            },
            AttitudeMap {
                sensor: "camera".to_owned(),
                mrp: named(&["p1", "p2", "p3"]),
                relative: true,
                ..AttitudeMap::default()
            },
        ],
        ..FileMap::default()
    });
    let table = read_text(text, &options).unwrap();
    let last = |sensor: &str, name: &str| table.sensor_channel(sensor, name).unwrap().values[1];
    for (sensor, z) in [("back", 0.8), ("camera", -0.8)] {
        let found = [last(sensor, "relative_q_z"), last(sensor, "relative_q_w")];
        let gap = (found[0] - z).abs().max((found[1] - 0.6).abs());
        assert!(gap < 1.0e-15, "{sensor}: {found:?}");
    }
    assert!(table.channels.iter().all(|c| !c.name.starts_with("q_")));
}

#[test]
fn exact_late_times_and_rates_in_inertial_axes() {
    let column = |channel: &str, late_s: Option<f64>| ColumnMap {
        late_s,
        ..ColumnMap::new(channel, channel, "rad/s")
    };
    let late = [
        column("omega_x", Some(0.5)),
        column("omega_y", Some(0.5)),
        column("omega_z", Some(0.5)),
    ];
    let mut options = of(FileMap {
        columns: late.to_vec(),
        attitude: vec![AttitudeMap {
            quaternion: named(&["q_x", "q_y", "q_z", "q_w"]),
            late_s: Some(1.0),
            ..AttitudeMap::default()
        }],
        ..FileMap::default()
    });
    options.map.inertial_rates = true;
    options.check_conventions = false;
    // A body that is turned by a quarter about z: its x axis is y of inertial axes.
    let half = 0.5_f64.sqrt();
    let row = |k: u32| format!("{k},0,1,0,0,0,{half},{half}\n");
    let rows: String = (0..9).map(row).collect();
    let text = format!("time_s,omega_x,omega_y,omega_z,q_x,q_y,q_z,q_w\n{rows}");
    let table = read_text(text, &options).unwrap();
    let [q, x, y] = ["q_w", "omega_x", "omega_y"].map(|name| table.channel(name).unwrap());
    assert_eq!((q.time_s[0], q.time_s[8]), (-1.0, 7.0));
    // At 7.5 s there is no attitude.
    assert_eq!((x.time_s[0], x.time_s.last()), (-0.5, Some(&6.5)));
    assert!(x.values.iter().all(|w| (w - 1.0).abs() < 1e-14));
    assert!(y.values.iter().all(|w| w.abs() < 1e-14));
    let left_out = "1 sample of omega_x..z left out: no attitude at the same time";
    assert!(
        table.repairs.iter().any(|r| r == left_out),
        "{:?}",
        table.repairs
    );
    // Without an attitude nothing turns them.
    options.map.all = FileMap::default();
    let text = "time_s,omega_x,omega_y,omega_z\n0,0,1,0\n1,0,1,0\n";
    let error = read_text(text, &options);
    let error = error.unwrap_err();
    assert!(
        error.starts_with("E0212") && error.contains("inertial_rates"),
        "{error}"
    );
}

/// Of 0.4 N m s a wheel of 0.05 kg m2 has 8 rad/s; without a model it has no speed.
#[test]
fn exact_a_momentum_is_a_speed_by_the_spin_inertia() {
    let column = ColumnMap {
        sign: Some(-1.0),
        offset: Some(100.0),
        invalid: vec!["-999".to_owned()],
        ..ColumnMap::new("rw1_rad_s", "H1", "mN m s")
    };
    let mut options = of(FileMap {
        columns: vec![column],
        ..FileMap::default()
    });
    let text = "time_s,H1,rw2_rad_s\n0,300,1\n1,-999,2\n2,-600,3\n";
    let table = read_text(text, &options).unwrap();
    assert!(table.channel("rw1_rad_s").is_none() && table.channel("rw2_rad_s").is_some());
    let told = table.repairs.join("\n");
    assert!(
        told.contains(
            "rw1_rad_s: not read: the spin inertia of a wheel, over which a momentum is its speed, is not known; give --model"
        ),
        "{told}"
    );
    options.spin_inertia = Some([("rw1".to_owned(), 0.05)].into());
    let table = read_text(text, &options).unwrap();
    let speed = table.channel("rw1_rad_s").unwrap();
    assert_eq!(*speed.time_s, [0.0, 2.0]);
    let off = speed.values.iter().zip([-8.0, 10.0]).map(|(a, b)| a - b);
    assert!(off.fold(0.0, |m: f64, x| m.max(x.abs())) < 1e-14);
    options.spin_inertia = Some([("rw2".to_owned(), 0.05)].into());
    assert_told(
        &read_text(text, &options).unwrap_err(),
        "E0212 map of channel 'rw1_rad_s'",
        "is not known; name a wheel of the model whose spin inertia is not estimated",
    );
    let torque = ColumnMap::new("rw1_Nm", "H1", "N m s");
    let fault = poinsot_telemetry::map_faults(&map_of(vec![torque], Vec::new())).remove(0);
    assert_eq!(fault.refused.problem, "unit 'N m s' does not measure it");
}
