//! Every key of the map of telemetry, with an example file and the values that it gives by hand.

use poinsot_model::parse_telemetry_map;
use poinsot_telemetry::{ReadOptions, Table, full_name, read};
use serde_json::Value;
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2 as QUARTER, FRAC_PI_4, PI, SQRT_2, TAU};

/// A channel with its times, s, and values, SI.
type Expected = (&'static str, Vec<f64>, Vec<f64>);

/// An example of one key.
struct Example {
    key: &'static str,
    map: &'static str,
    file: &'static str,
    channels: Vec<Expected>,
    /// Instant in UTC from which the times count, where the file has dates.
    origin: Option<&'static str>,
}

fn example(
    key: &'static str,
    map: &'static str,
    file: &'static str,
    channels: Vec<Expected>,
) -> Example {
    Example {
        key,
        map,
        file,
        channels,
        origin: None,
    }
}

/// Two samples a second apart.
fn two(name: &'static str, values: [f64; 2]) -> Vec<Expected> {
    vec![(name, vec![0.0, 1.0], values.into())]
}

/// A rotation about z by a quarter turn, at two times.
fn quarter(names: [&'static str; 2]) -> Vec<Expected> {
    let half = SQRT_2 / 2.0;
    names
        .map(|name| (name, vec![0.0, 1.0], vec![half, half]))
        .into()
}

const WX: &str = "time_s,wx\n0,180\n1,90\n";
/// About z by a quarter turn: as a matrix, by angles.
const TURNED: &str = "time_s,a,b,c,d,e,f,g,h,i\n0,0,-1,0,1,0,0,0,0,1\n1,0,-1,0,1,0,0,0,0,1\n";
const ANGLES: &str = "time_s,yaw,pitch,roll\n0,90,0,0\n1,90,0,0\n";
const VECTOR_PART: &str = "time_s,a,b,c,d\n0,0,0,0.6,0.8\n1,0,0,0.6,0.8\n";
const POSITION: &str = "time_s,x,y,z,u,v,w\n0,7000,0,1,0,7.5,0\n1,7000,7.5,1,0,7.5,0.001\n";
const PULSES: &str = "time_s,ON\n0,\n1,500\n2,1000\n2.4,1000\n";

fn layout() -> Vec<Example> {
    let rate = || two("omega_x", [1.0, 2.0]);
    vec![
        example(
            "delimiter",
            "delimiter = ';'",
            "time_s;omega_x\n0;1\n1;2\n",
            rate(),
        ),
        example(
            "comment",
            "comment = '#'",
            "# log\ntime_s,omega_x\n0,1\n# cut\n1,2\n",
            rate(),
        ),
        example(
            "header_row",
            "header_row = 3",
            "Export\nv 2\ntime_s,omega_x\n0,1\n1,2\n",
            rate(),
        ),
        example(
            "decimal",
            "delimiter = ';'\ndecimal = ','",
            "time_s;omega_x\n0,25;1,5\n0,75;2,5\n",
            vec![("omega_x", vec![0.25, 0.75], vec![1.5, 2.5])],
        ),
        example(
            "units_row",
            "units_row = true",
            "time_s,omega_x\nms,deg/s\n0,180\n500,90\n",
            vec![("omega_x", vec![0.0, 0.5], vec![PI, QUARTER])],
        ),
        example(
            "where",
            "where = { UNIT = 'A' }",
            "time_s,UNIT,omega_x\n0,A,1\n0.5,B,5\n1,A,2\n",
            rate(),
        ),
        example(
            "columns",
            "columns.omega_x = { column = 'wx', unit = 'deg/s' }",
            WX,
            two("omega_x", [PI, QUARTER]),
        ),
        example(
            "file.name",
            "[[telemetry.file]]\nname = 'r*.csv'\ncolumns.omega_x = { column = 'wx', unit = 'deg/s' }",
            WX,
            two("omega_x", [PI, QUARTER]),
        ),
        example(
            "file",
            "[[telemetry.file]]\nname = 'run.csv'\ndelimiter = ';'",
            "time_s;omega_x\n0;1\n1;2\n",
            rate(),
        ),
    ]
}

fn columns() -> Vec<Example> {
    let turned = || two("omega_x", [PI, QUARTER]);
    let joint = |values| two("joint1_rad", values);
    let thrust = |times: &[f64]| {
        vec![(
            "thr1_N",
            times.to_vec(),
            (0..times.len()).map(|k| [0.9, 0.0][k % 2]).collect(),
        )]
    };
    vec![
        example(
            "columns.column",
            "columns.omega_x = { column = 'w x', unit = 'rad/s' }",
            "time_s,w x\n0,3\n1,4\n",
            two("omega_x", [3.0, 4.0]),
        ),
        example(
            "columns.unit",
            "columns.omega_x = { column = 'wx', unit = 'deg/s' }",
            WX,
            turned(),
        ),
        example(
            "columns.sign",
            "columns.omega_x = { column = 'wx', unit = 'deg/s', sign = -1 }",
            WX,
            two("omega_x", [-PI, -QUARTER]),
        ),
        example(
            "columns.scale",
            "columns.omega_x = { column = 'wx', unit = 'deg/s', scale = 0.5 }",
            WX,
            two("omega_x", [QUARTER, FRAC_PI_4]),
        ),
        example(
            "columns.offset",
            "columns.omega_x = { column = 'wx', unit = 'deg/s', offset = -90 }",
            WX,
            two("omega_x", [QUARTER, 0.0]),
        ),
        example(
            "columns.counts_per_revolution",
            "columns.joint1_rad = { column = 'E1', counts_per_revolution = 4096 }",
            "time_s,E1\n0,1024\n1,-2048\n",
            joint([QUARTER, -PI]),
        ),
        example(
            "columns.nominal_N",
            "columns.thr1_N = { column = 'VALVE', nominal_N = 0.9 }",
            "time_s,VALVE\n0,ON\n1,OFF\n",
            two("thr1_N", [0.9, 0.0]),
        ),
        example(
            "columns.where",
            "columns.omega_x = { column = 'VALUE', unit = 'rad/s', where = { NAME = 'X' } }\ncolumns.omega_y = { column = 'VALUE', unit = 'rad/s', where = { NAME = 'Y' } }",
            "time_s,NAME,VALUE\n0,X,1\n0,Y,3\n1,X,2\n1,Y,4\n",
            [two("omega_x", [1.0, 2.0]), two("omega_y", [3.0, 4.0])].concat(),
        ),
        example(
            "columns.invalid",
            "columns.omega_x = { column = 'wx', unit = 'rad/s', invalid = [-999, 'N/A'] }",
            "time_s,wx\n0,1\n0.25,-999\n0.5,N/A\n1,2\n",
            two("omega_x", [1.0, 2.0]),
        ),
        example(
            "columns.signed_range",
            "columns.omega_x = { column = 'wx', unit = 'mrad/s', signed_range = 65536 }",
            "time_s,wx\n0,65535\n1,32767\n",
            two("omega_x", [-1e-3, 32.767]),
        ),
        example(
            "columns.wraps_at",
            "columns.joint1_rad = { column = 'E1', unit = 'deg', wraps_at = 360 }",
            "time_s,E1\n0,330\n1,30\n",
            joint([330.0 / 360.0 * TAU, 390.0 / 360.0 * TAU]),
        ),
        example(
            "columns.increments",
            "columns.omega_x = { column = 'dx', unit = 'rad', increments = true }",
            "time_s,dx\n0,9\n2,0.2\n3,0.4\n",
            vec![("omega_x", vec![1.0, 2.5], vec![0.1, 0.4])],
        ),
        example(
            "columns.late_s",
            "columns.omega_x = { column = 'wx', unit = 'rad/s', late_s = 0.25 }",
            "time_s,wx,omega_y\n1,3,1\n2,4,2\n",
            vec![
                ("omega_x", vec![0.75, 1.75], vec![3.0, 4.0]),
                ("omega_y", vec![1.0, 2.0], vec![1.0, 2.0]),
            ],
        ),
        example(
            "columns.opens_late_s",
            "columns.thr1_N = { column = 'ON', unit = 'ms', nominal_N = 0.9, opens_late_s = 0.25 }",
            "time_s,ON\n0,\n1,500\n2,1000\n",
            thrust(&[1.25, 1.5, 2.25, 3.0]),
        ),
        example(
            "columns.closes_late_s",
            "columns.thr1_N = { column = 'ON', unit = 'ms', nominal_N = 0.9, closes_late_s = 0.25 }",
            "time_s,ON\n0,\n1,500\n2,1000\n",
            thrust(&[1.0, 1.75, 2.0, 3.25]),
        ),
        // Open until both have ended: from 2 s to 3.4 s.
        example(
            "columns.overlap",
            "columns.thr1_N = { column = 'ON', unit = 'ms', nominal_N = 0.9, overlap = 'merged' }",
            PULSES,
            thrust(&[1.0, 1.5, 2.0, 3.4]),
        ),
    ]
}

fn times() -> Vec<Example> {
    let rate = || two("omega_x", [1.0, 2.0]);
    let dated = |key, map, file, origin| Example {
        origin: Some(origin),
        ..example(key, map, file, rate())
    };
    vec![
        example(
            "time",
            "time = { column = 'OBT' }",
            "OBT,omega_x\n0,1\n1,2\n",
            rate(),
        ),
        example(
            "time.column",
            "time = { column = 'b' }",
            "a,b,omega_x\n5,0,1\n9,1,2\n",
            rate(),
        ),
        example(
            "time.unit",
            "time = { column = 't', unit = 'ms' }",
            "t,omega_x\n0,1\n1000,2\n",
            rate(),
        ),
        dated(
            "time.format",
            "time = { column = 'UTC', format = 'day_of_year' }",
            "UTC,omega_x\n2026-073T18:19:00,1\n2026-073T18:19:01,2\n",
            "2026-03-14T18:19:00",
        ),
        // 20,526 days and 65,940 s after 1970 began.
        dated(
            "time.epoch",
            "time = { column = 't', epoch = 'unix' }",
            "t,omega_x\n1773512340,1\n1773512341,2\n",
            "2026-03-14T18:19:00",
        ),
        // TAI is 37 s ahead of UTC.
        dated(
            "time.scale",
            "time = { column = 't', format = 'iso8601', scale = 'TAI' }",
            "t,omega_x\n2026-03-14T18:19:37,1\n2026-03-14T18:19:38,2\n",
            "2026-03-14T18:19:00",
        ),
        // Week 2409 begins on 8 March 2026; GPS is 18 s ahead of UTC: 6 d 18 h 19 min 18 s.
        dated(
            "time.week",
            "time = { column = 'TOW', format = 'gps_week', week = 'WEEK' }",
            "WEEK,TOW,omega_x\n2409,584358,1\n2409,584359,2\n",
            "2026-03-14T18:19:00",
        ),
    ]
}

fn attitudes() -> Vec<Example> {
    let about_z = || [two("q_z", [0.6, 0.6]), two("q_w", [0.8, 0.8])].concat();
    let half = SQRT_2 / 2.0;
    vec![
        example(
            "attitude",
            "attitude = [{ quaternion = ['a', 'b', 'c', 'd'] }]",
            VECTOR_PART,
            about_z(),
        ),
        // The scalar part is not negative: 0.8.
        example(
            "attitude.quaternion",
            "attitude = [{ quaternion = ['a', 'b', 'c'] }]",
            VECTOR_PART,
            about_z(),
        ),
        example(
            "attitude.order",
            "attitude = [{ quaternion = ['d', 'a', 'b', 'c'], order = 'wxyz' }]",
            VECTOR_PART,
            about_z(),
        ),
        example(
            "attitude.sense",
            "attitude = [{ quaternion = ['a', 'b', 'c', 'd'], sense = 'inertial_to_body' }]",
            VECTOR_PART,
            [two("q_z", [-0.6, -0.6]), two("q_w", [0.8, 0.8])].concat(),
        ),
        example(
            "attitude.sensor",
            "attitude = [{ sensor = 'st2', quaternion = ['a', 'b', 'c', 'd'] }]",
            VECTOR_PART,
            [two("st2.q_z", [0.6, 0.6]), two("st2.q_w", [0.8, 0.8])].concat(),
        ),
        example(
            "attitude.relative",
            "attitude = [{ sensor = 'camera', quaternion = ['a', 'b', 'c', 'd'], relative = true }]",
            VECTOR_PART,
            [
                two("camera.relative_q_z", [0.6, 0.6]),
                two("camera.relative_q_w", [0.8, 0.8]),
            ]
            .concat(),
        ),
        example(
            "attitude.matrix",
            "attitude = [{ matrix = ['a', 'b', 'c', 'd', 'e', 'f', 'g', 'h', 'i'] }]",
            TURNED,
            quarter(["q_z", "q_w"]),
        ),
        example(
            "attitude.euler",
            "attitude = [{ euler = ['yaw', 'pitch', 'roll'], sequence = 'ZYX', unit = 'deg' }]",
            ANGLES,
            quarter(["q_z", "q_w"]),
        ),
        // The first angle is about x.
        example(
            "attitude.sequence",
            "attitude = [{ euler = ['yaw', 'pitch', 'roll'], sequence = 'XYZ', unit = 'deg' }]",
            ANGLES,
            quarter(["q_x", "q_w"]),
        ),
        example(
            "attitude.unit",
            "attitude = [{ euler = ['yaw', 'pitch', 'roll'], sequence = 'ZYX', unit = 'rev' }]",
            "time_s,yaw,pitch,roll\n0,0.25,0,0\n1,0.25,0,0\n",
            quarter(["q_z", "q_w"]),
        ),
        // tan(90 deg / 4) = sqrt(2) - 1.
        example(
            "attitude.mrp",
            "attitude = [{ mrp = ['s1', 's2', 's3'] }]",
            "time_s,s1,s2,s3\n0,0,0,0.41421356237309505\n1,0,0,0.41421356237309505\n",
            quarter(["q_z", "q_w"]),
        ),
        example(
            "attitude.where",
            "attitude = [{ quaternion = ['a', 'b', 'c', 'd'], where = { OK = '1' } }]",
            "time_s,a,b,c,d,OK\n0,0,0,0.6,0.8,1\n0.5,1,0,0,0,0\n1,0,0,0.6,0.8,1\n",
            about_z(),
        ),
        example(
            "attitude.invalid",
            "attitude = [{ quaternion = ['a', 'b', 'c', 'd'], invalid = [9] }]",
            "time_s,a,b,c,d\n0,0,0,0.6,0.8\n0.5,9,9,9,9\n1,0,0,0.6,0.8\n",
            about_z(),
        ),
        example(
            "attitude.late_s",
            "attitude = [{ quaternion = ['a', 'b', 'c', 'd'], late_s = 0.5 }]",
            "time_s,a,b,c,d,omega_x\n1,0,0,0.6,0.8,1\n2,0,0,0.6,0.8,2\n",
            vec![
                ("q_w", vec![0.5, 1.5], vec![0.8, 0.8]),
                ("omega_x", vec![1.0, 2.0], vec![1.0, 2.0]),
            ],
        ),
        // The axis x of the body is y of inertial axes.
        example(
            "inertial_rates",
            "inertial_rates = true",
            "time_s,omega_x,omega_y,omega_z,q_x,q_y,q_z,q_w\n0,0,1,0,0,0,0.7071067811865476,0.7071067811865476\n1,0,2,0,0,0,0.7071067811865476,0.7071067811865476\n",
            [
                two("omega_x", [1.0, 2.0]),
                two("omega_y", [0.0, 0.0]),
                two("q_z", [half, half]),
            ]
            .concat(),
        ),
        example(
            "body_velocities",
            "body_velocities = true",
            "time_s,v_x,v_y,v_z,q_x,q_y,q_z,q_w\n0,1,0,0,0,0,0.7071067811865476,0.7071067811865476\n1,2,0,0,0,0,0.7071067811865476,0.7071067811865476\n",
            [two("v_x", [0.0, 0.0]), two("v_y", [1.0, 2.0])].concat(),
        ),
        example(
            "body_positions",
            "body_positions = true",
            "time_s,r_x,r_y,r_z,q_x,q_y,q_z,q_w\n0,1,0,0,0,0,0.7071067811865476,0.7071067811865476\n1,2,0,0,0,0,0.7071067811865476,0.7071067811865476\n",
            [two("r_x", [0.0, 0.0]), two("r_y", [1.0, 2.0])].concat(),
        ),
    ]
}

/// The orbital frame turns about -y by 1 rad in 1,000 s.
fn orbits() -> Vec<Example> {
    let frame =
        "time_s,omega_x,omega_y,omega_z,q_x,q_y,q_z,q_w\n0,0,0,0,0,0,0,1\n1000,0,0,0,0,0,0,1\n";
    let (sin, cos) = 0.5_f64.sin_cos();
    let at = |name, values: [f64; 2]| (name, vec![0.0, 1000.0], values.to_vec());
    let attitude = || vec![at("q_y", [0.0, -sin]), at("q_w", [1.0, cos])];
    let orbit = || {
        [
            two("orbit_x", [7e6, 7e6]),
            two("orbit_y", [0.0, 7.5e3]),
            two("orbit_z", [1e3, 1e3]),
        ]
        .concat()
    };
    let moving = || [orbit(), two("v_y", [7.5e3, 7.5e3]), two("v_z", [0.0, 1.0])].concat();
    // Earth rotation angle at noon of 1 January 2000 (IERS Conventions 2010, eq. 5.15).
    let angle = TAU * 0.779_057_273_264;
    vec![
        example(
            "orbital_frame",
            "orbital_frame = { rate_rad_s = 0.001 }",
            frame,
            attitude(),
        ),
        example(
            "orbital_frame.rate_rad_s",
            "orbital_frame = { rate_rad_s = -0.001 }",
            frame,
            vec![at("q_y", [0.0, sin]), at("omega_y", [0.0, 0.0])],
        ),
        example(
            "orbital_frame.rates",
            "orbital_frame = { rate_rad_s = 0.001, rates = true }",
            frame,
            [attitude(), vec![at("omega_y", [-1e-3, -1e-3])]].concat(),
        ),
        example(
            "orbit",
            "orbit = { position = ['x', 'y', 'z'], unit = 'km' }",
            POSITION,
            orbit(),
        ),
        example(
            "orbit.position",
            "orbit = { position = ['y', 'x', 'z'], unit = 'km' }",
            POSITION,
            [two("orbit_y", [7e6, 7e6]), two("orbit_x", [0.0, 7.5e3])].concat(),
        ),
        example(
            "orbit.unit",
            "orbit = { position = ['x', 'y', 'z'], unit = 'm' }",
            POSITION,
            two("orbit_x", [7e3, 7e3]),
        ),
        example(
            "orbit.velocity",
            "orbit = { position = ['x', 'y', 'z'], unit = 'km', velocity = ['u', 'v', 'w'], velocity_unit = 'km/s' }",
            POSITION,
            moving(),
        ),
        example(
            "orbit.velocity_unit",
            "orbit = { position = ['x', 'y', 'z'], unit = 'km', velocity = ['u', 'v', 'w'], velocity_unit = 'm/s' }",
            POSITION,
            [orbit(), two("v_y", [7.5, 7.5])].concat(),
        ),
        Example {
            origin: Some("2000-01-01T12:00:00"),
            ..example(
                "orbit.frame",
                "time = { column = 'UTC', format = 'iso8601' }\norbit = { position = ['x', 'y', 'z'], unit = 'm', frame = 'earth_fixed' }",
                "UTC,x,y,z,omega_x\n2000-01-01T12:00:00Z,7000000,0,5,1\n2000-01-01T12:00:00.001Z,7000000,0,5,1\n",
                vec![
                    ("orbit_x", vec![0.0], vec![7e6 * angle.cos()]),
                    ("orbit_y", vec![0.0], vec![7e6 * angle.sin()]),
                    ("orbit_z", vec![0.0], vec![5.0]),
                ],
            )
        },
    ]
}

fn examples() -> Vec<Example> {
    let all = [layout(), columns(), times(), attitudes(), orbits()];
    all.into_iter().flatten().collect()
}

/// The table that an example gives, with its map or without.
fn table(of: &Example, with_map: bool) -> Result<Table, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    std::fs::write(&path, of.file).unwrap();
    let described = |map: &str| parse_telemetry_map(&format!("[telemetry]\n{map}\n"), "map.toml");
    let mut options = ReadOptions::default();
    if let Some(origin) = of.origin {
        let first = folder.path().join("first.csv");
        std::fs::write(&first, format!("t,omega_x\n{origin}Z,0\n")).unwrap();
        let utc = "time = { column = 't', format = 'iso8601' }";
        let dated = ReadOptions {
            map: described(utc).unwrap(),
            ..ReadOptions::default()
        };
        options.origin = read(&[first], &dated).unwrap().origin;
    }
    if with_map {
        options.map = described(of.map).map_err(|e| e.to_string())?;
    }
    read(&[path], &options).map_err(|e| e.to_string())
}

/// What of an example is not as expected; empty where all is.
fn wrong(of: &Example, table: &Result<Table, String>) -> String {
    let table = match table {
        Ok(table) => table,
        Err(error) => return error.clone(),
    };
    for (name, times, values) in &of.channels {
        let Some(found) = table
            .channels
            .iter()
            .find(|c| full_name(&c.sensor, &c.name) == *name)
        else {
            return format!("no channel {name}");
        };
        // Where fewer samples are expected, the first.
        let near = |a: &[f64], b: &[f64]| {
            let most = values.iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            a.len() >= b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * most)
        };
        let same = found.values.len() == values.len() || of.key == "orbit.frame";
        if !same || !near(&found.time_s, times) || !near(&found.values, values) {
            return format!(
                "{name}: {:?} {:?}, not {times:?} {values:?}",
                found.time_s, found.values
            );
        }
    }
    String::new()
}

/// Each example gives its values with its map, and not without it.
#[test]
fn exact_every_key_of_the_map_has_an_example() {
    for one in examples() {
        let own = one.key.rsplit('.').next().unwrap();
        assert!(one.map.contains(own), "{}: not in its map", one.key);
        assert_eq!(wrong(&one, &table(&one, true)), "", "{}", one.key);
        assert_ne!(
            wrong(&one, &table(&one, false)),
            "",
            "{} without its map",
            one.key
        );
    }
}

/// Tables of the schema, and what stands before their keys.
const TABLES: [(&str, &str); 7] = [
    ("TelemetryFile", ""),
    ("ExportFile", "file."),
    ("ColumnFile", "columns."),
    ("TimeFile", "time."),
    ("AttitudeFile", "attitude."),
    ("OrbitColumnsFile", "orbit."),
    ("OrbitalFile", "orbital_frame."),
];

/// Every key of the schema has one example, a row of the reference, and a word in the page about exports.
#[test]
fn unit_every_key_of_the_map_is_listed() {
    let schema = poinsot_model::telemetry_map_schema();
    let keys = |table: &Value| -> BTreeSet<String> {
        let own = table["properties"].as_object();
        own.into_iter()
            .flat_map(|own| own.keys().cloned())
            .collect()
    };
    let all = schema["$defs"].as_object().unwrap().iter();
    let whole = &schema["properties"]["telemetry"];
    let of_all_files = keys(whole);
    let all = all.map(|(name, table)| (name.as_str(), table));
    let all = all.chain([("TelemetryFile", whole)]);
    let mut known = BTreeSet::new();
    for (name, table) in all.filter(|t| !keys(t.1).is_empty()) {
        let prefix = TABLES
            .iter()
            .find(|t| t.0 == name)
            .unwrap_or_else(|| panic!("{name} has no example"))
            .1;
        let own = keys(table).into_iter();
        let own = own.filter(|key| name != "ExportFile" || !of_all_files.contains(key));
        known.extend(own.map(|key| format!("{prefix}{key}")));
    }
    let shown: Vec<String> = examples().iter().map(|one| one.key.to_owned()).collect();
    let shown_once: BTreeSet<String> = shown.iter().cloned().collect();
    assert_eq!(shown.len(), shown_once.len(), "two examples of one key");
    assert_eq!(shown_once, known);
    let docs = |name: &str| {
        let path = crate::shared::shipped()
            .join("../docs/reference")
            .join(name);
        std::fs::read_to_string(path).unwrap()
    };
    let (formats, page) = (docs("formats.md"), docs("telemetry.md"));
    for key in known {
        let own = key.rsplit('.').next().unwrap();
        assert!(
            formats.contains(&format!("| `{own}` |")),
            "{key} has no row"
        );
        let word = |c: char| c.is_alphanumeric() || c == '_';
        assert!(
            page.split(|c| !word(c)).any(|w| w == own),
            "{key} is not explained"
        );
    }
}
