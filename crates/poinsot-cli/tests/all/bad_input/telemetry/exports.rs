//! Exports of ground stations, and maps that do not match them.

use crate::bad_input::bench::{Bench, CASE, MODEL};
use crate::bad_input::row::{Row, row};

fn map(b: &Bench, table: &str) {
    b.write("m.toml", format!("{MODEL}\n[telemetry]\n{table}\n"));
}

/// The telemetry with dates as times: seconds after 2026-03-14, 18 h UTC.
fn dates(b: &Bench, date: impl Fn(usize, f64) -> String) {
    b.spoil(|s| {
        for k in 0..s.rows.len() {
            let time = s.get(k, "time_s");
            s.set(k, "time_s", date(k, time));
        }
    });
}

fn iso(t: f64) -> String {
    let tenths = (t * 10.0).round() as i64;
    format!(
        "2026-03-14T18:{:02}:{:02}.{}Z",
        tenths / 600,
        tenths / 10 % 60,
        tenths % 10
    )
}

const ISO: &str = "time = { column = \"time_s\", format = \"iso8601\" }";
const CHECK: &[&str] = &["check", "m.toml"];

pub fn rows() -> Vec<Row> {
    vec![
        row("X1", "dates without a map", |b| dates(b, |_, t| iso(t)), 2, &["E0203 t.csv:2 column 'time_s': '2026-03-14T18:00:00.0Z' is a date; map it by [telemetry] time ="]),
        row("X1", "dates, mapped", |b| { dates(b, |_, t| iso(t)); map(b, ISO); }, 0, &[": Determined. "]),
        row("X1", "second 60 where no leap second is", |b| { dates(b, |k, t| if k == 9 { "2026-03-14T18:00:60".into() } else { iso(t) }); map(b, ISO); }, 2, &["E0203 t.csv:11 column 'time_s': '2026-03-14T18:00:60' has second 60, and there is no leap second then; correct the time"]),
        row("X1", "February 30", |b| { dates(b, |_, _| "2026-02-30T18:00:00".into()); map(b, ISO); }, 2, &["E0203 t.csv:2 column 'time_s': '2026-02-30T18:00:00' has no such day of the month; correct it"]),
        row("X1", "a zone in GPS time", |b| { dates(b, |_, t| iso(t).replace('Z', "+01:00")); map(b, "time = { column = \"time_s\", format = \"iso8601\", scale = \"GPS\" }"); }, 2, &["has a zone, and only UTC has zones; leave the zone out"]),
        row("X1", "dates mapped as numbers", |b| { dates(b, |_, t| iso(t)); map(b, "time = { column = \"time_s\", unit = \"s\" }"); }, 2, &["E0203 t.csv:2 column 'time_s': '2026-03-14T18:00:00.0Z' is a date"]),
        row("X1", "an epoch that is none", |b| map(b, "time = { column = \"time_s\", epoch = \"launch\" }"), 2, &["E0212 m.toml:", "telemetry.time.epoch = \"launch\": the epoch is not a date and time"]),
        row("X1", "a scale without an epoch", |b| map(b, "time = { column = \"time_s\", scale = \"TAI\" }"), 2, &["E0212 m.toml:", "numbers without an epoch have no scale; remove it, or add epoch"]),
        row("X1", "weeks without their column", |b| map(b, "time = { column = \"time_s\", format = \"gps_week\" }"), 2, &["E0212 m.toml:", "belong together"]),
        row("X1", "a time column that no file has", |b| map(b, "time = { column = \"UTC\", format = \"iso8601\" }"), 2, &["E0212 map of channel 'time': no column 'UTC' in t.csv"]),
        row("X2", "check: an unknown unit", |b| map(b, "columns.omega_x = { column = \"omega_x\", unit = \"furlong\" }"), 2, &["E0211 m.toml:", "telemetry.columns.omega_x.unit = \"furlong\": unit 'furlong' is not known; did you mean", "Use one of: rad/s, mrad/s, deg/s"]).run(CHECK),
        row("X2", "check: angles in rpm", |b| map(b, "attitude = [{ euler = [\"a\", \"b\", \"c\"], sequence = \"ZYX\", unit = \"rpm\" }]"), 2, &["E0212 m.toml:", "unit 'rpm' does not measure it; give a unit that converts to rad"]).run(CHECK),
        row("X2", "check: one column for two channels", |b| map(b, "columns.omega_x = { column = \"w\", unit = \"deg/s\" }\ncolumns.omega_y = { column = \"w\", unit = \"deg/s\" }"), 2, &["E0210 m.toml:", "column 'w' is mapped to 'omega_x' too; map each column once"]).run(CHECK),
        row("X2", "check: no unit and no row of units", |b| map(b, "columns.omega_x = { column = \"w\" }"), 2, &["E0212 m.toml:", "there is no unit; write unit ="]).run(CHECK),
        row("X2", "check: a nominal force of a gyro", |b| map(b, "columns.omega_x = { column = \"w\", nominal_N = 0.9 }"), 2, &["E0212 m.toml:", "only a thruster has a nominal force"]).run(CHECK),
        row("X2", "check: a sign of 2", |b| map(b, "columns.omega_x = { column = \"w\", unit = \"deg/s\", sign = 2 }"), 2, &["E0212 m.toml:", "the sign is neither 1 nor -1"]).run(CHECK),
        row("X2", "check: three columns of a quaternion", |b| map(b, "attitude = [{ quaternion = [\"a\", \"b\", \"c\"] }]"), 2, &["E0212 m.toml:", "3 columns are named where the form has 4"]).run(CHECK),
        row("X2", "check: Euler angles without a sequence", |b| map(b, "attitude = [{ euler = [\"a\", \"b\", \"c\"], unit = \"deg\" }]"), 2, &["E0107 m.toml:", "Euler angles and their sequence belong together"]).run(CHECK),
        row("X2", "check: a delimiter of two characters", |b| map(b, "delimiter = \";;\""), 2, &["E0107 m.toml:", "the value must be one character that is in no number or name"]).run(CHECK),
        row("X2", "check: an inclination in degrees", |b| b.write("m.toml", format!("{MODEL}\n[environment]\ngravity = \"point_mass\"\ngm_m3_s2 = 3.986e14\ngravity_gradient = true\norbit = {{ semi_major_axis_m = 7e6, inclination_rad = 97.8 }}\n")), 2, &["E0108 m.toml:", "environment.orbit.inclination_rad = 97.8: the angle is beyond 3.14159 rad; write radians; 97.8 deg are 1.70693 rad"]).run(CHECK),
        row("X2", "check: a mass of 1e-308 kg", |b| b.model("mass_kg = 150.0", "mass_kg = 1e-308"), 2, &["E0108 m.toml:", "the mass is below 1e-12 kg"]).run(CHECK),
        row("X2", "check: a map with an unknown unit", |b| b.write("map.toml", "[telemetry.columns]\nomega_x = { column = \"w\", unit = \"furlong\" }\n"), 2, &["E0211 map.toml:2:", "unit 'furlong' is not known"]).run(&["check", "map.toml"]),
        row("X2", "check: a pulse as long as an angle", |b| b.write("map.toml", "[telemetry.columns]\nthr1_N = { column = \"ON\", unit = \"deg\", nominal_N = 0.9 }\n"), 2, &["E0212 map.toml:2:", "telemetry.columns.thr1_N.unit = \"deg\": unit 'deg' does not measure it; give a unit that converts to s"]).run(&["check", "map.toml"]),
        row("X2", "check: a velocity in km", |b| map(b, "orbit = { position = [\"x\", \"y\", \"z\"], unit = \"km\", velocity = [\"u\", \"v\", \"w\"], velocity_unit = \"km\" }"), 2, &["E0212 m.toml:", "telemetry.orbit.velocity_unit = \"km\": unit 'km' does not measure it"]).run(CHECK),
        row("X2", "check: a case with an unknown key", |b| b.write("case.toml", CASE.replace("duration_s", "duration")), 2, &["E0502 case.toml:3: unknown field `duration`; did you mean \"duration_s\"?"]).run(&["check", "case.toml"]),
        row("X2", "check: a case for a wheel that is not there", |b| { b.write("truth.toml", crate::bad_input::bench::truth()); b.write("case.toml", CASE.replace("\"wheel1\"", "\"weel1\"")); }, 2, &["E0504 case.toml:12: wheel_motion[0].wheel = \"weel1\"", "did you mean \"wheel1\"?"]).run(&["check", "case.toml"]),
        row("X2", "check: a case without its model", |b| b.write("case.toml", CASE), 2, &["E0101 truth.toml: there is no such file; check the path"]).run(&["check", "case.toml"]),
        row("X2", "check: a plan without an experiment", |b| b.write("plan.toml", "schema = \"poinsot.plan/1\"\nexperiment = []\n"), 2, &["E0541 plan.toml:2: experiment", "there is no experiment; add [[experiment]] with a case"]).run(&["check", "plan.toml"]),
        row("X2", "check: a plan with an unknown address", |b| { b.write("truth.toml", crate::bad_input::bench::truth()); b.write("case.toml", CASE); b.write("plan.toml", "schema = \"poinsot.plan/1\"\ntrials = 2\n[[experiment]]\ncase = \"case.toml\"\n[[vary]]\nnumber = \"bus.mas_kg\"\nvalues = [1.0]\n"); }, 2, &["E0542 plan.toml:6: vary[0].number", "did you mean \"mass_kg\"?"]).run(&["check", "plan.toml"]),
        row("X2", "check: an answer of another format", |b| b.write("estimate.json", "{\"schema\": \"poinsot.truth/2\"}"), 2, &["E0601 estimate.json:", "its schema is \"poinsot.truth/2\", not poinsot.estimate/2"]).run(&["check", "estimate.json"]),
        row("X2", "check: an answer with an impossible status", |b| { let done = b.run(crate::bad_input::row::IDENTIFY); assert_eq!(done.exit, 0); let t = std::fs::read_to_string(b.path("out/estimate.json")).unwrap(); b.write("estimate.json", t.replace("\"converged\"", "\"fine\"")); }, 2, &["E0604 estimate.json: status = \"fine\": the status is none of converged, partial"]).run(&["check", "estimate.json"]),
        row("X3", "a pulse of negative duration", |b| { b.spoil(|s| { s.header.push("ON".into()); s.rows.iter_mut().for_each(|r| r.push("-3".into())); }); b.write("m.toml", format!("{MODEL}\n[[thruster]]\nname = \"thr1\"\nbody = \"bus\"\nposition_m = [0.0, 0.0, 0.0]\nforce_direction = [1.0, 0.0, 0.0]\n\n[telemetry]\ncolumns.thr1_N = {{ column = \"ON\", unit = \"ms\", nominal_N = 0.9 }}\n")); }, 2, &["E0203 t.csv:2 column 'ON': '-0.003' is a negative duration"]),
        row("X3", "a comment above the header", |b| { let t = std::fs::read_to_string(b.path("t.csv")).unwrap(); b.write("t.csv", format!("# export\n{t}")); }, 2, &["E0205 t.csv:1: the first row begins with '#'; write [telemetry] comment = \"#\""]),
        row("X3", "the same, mapped", |b| { let t = std::fs::read_to_string(b.path("t.csv")).unwrap(); b.write("t.csv", format!("# export\n{t}")); map(b, "comment = \"#\""); }, 0, &[": Determined. "]),
        row("X3", "a row of units that is not declared", |b| b.spoil(|s| { let units = "s,rad/s,rad/s,rad/s,-,-,-,-,rad/s,rad/s,rad/s"; s.rows.insert(0, units.split(',').map(str::to_owned).collect()); }), 2, &["E0203 t.csv:2 column 'time_s': 's' is not a number"]),
        row("X3", "a row of units with an unknown one", |b| { b.spoil(|s| { let units = "s,furlong,rad/s,rad/s,-,-,-,-,rad/s,rad/s,rad/s"; s.rows.insert(0, units.split(',').map(str::to_owned).collect()); }); map(b, "units_row = true"); }, 2, &["E0212 map of channel 'omega_x': t.csv: the units row has 'furlong', which is no angular velocity"]),
        row("X3", "a flag that is none", |b| { b.spoil(|s| { s.header.push("THR".into()); s.rows.iter_mut().for_each(|r| r.push("0.4".into())); }); b.write("m.toml", format!("{MODEL}\n[[thruster]]\nname = \"thr1\"\nbody = \"bus\"\nposition_m = [0.0, 0.0, 0.0]\nforce_direction = [1.0, 0.0, 0.0]\n\n[telemetry]\ncolumns.thr1_N = {{ column = \"THR\", nominal_N = 0.9 }}\n")); }, 2, &["E0203 t.csv:2 column 'THR': '0.4' is no flag; write 0 or 1"]),
        row("X3", "files given one by one", |b| { b.spoil(|s| s.without("wheel")); let mut w = crate::bad_input::bench::sheet(); w.without("q_"); w.without("omega"); b.write("u.csv", w.text()); }, 2, &["E0301 t.csv: no channel 'wheel1_rad_s'", "join the files of one segment by commas: --telemetry a.csv,b.csv"]).more(&["--telemetry", "u.csv"]),
        row("X3", "an orbit in axes of the Earth without dates", |b| { b.spoil(|s| { s.header.extend(["x", "y", "z"].map(str::to_owned)); s.rows.iter_mut().for_each(|r| r.extend(["7000.0", "0.0", "0.0"].map(str::to_owned))); }); b.write("m.toml", format!("{MODEL}\n[environment]\ngravity = \"point_mass\"\ngm_m3_s2 = 3.986e14\ngravity_gradient = true\n\n[telemetry]\norbit = {{ position = [\"x\", \"y\", \"z\"], unit = \"km\", frame = \"earth_fixed\" }}\n")); }, 2, &["E0212 map of channel 'orbit': t.csv: axes that turn with the Earth need the date, and 'time_s' counts from an unknown epoch"]),
        row("X3", "packed data that are damaged", |b| { b.write("t.csv.gz", [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 1, 2, 3]); }, 2, &["E0202 t.csv.gz: the packed data are damaged"]).run(&["identify", "--model", "m.toml", "--telemetry", "t.csv.gz", "--out", "out"]),
    ]
}
