//! Codes not reached by the list of faults: each is provoked once.

use crate::bad_input::bench::{Bench, CASE, MODEL, truth};
use crate::bad_input::row::{Row, row};

const SIMULATE: &[&str] = &["simulate", "case.toml", "--out", "sim"];
pub const TWO: &[&str] = &[
    "identify",
    "--model",
    "m.toml",
    "--telemetry",
    "t.csv,u.csv",
    "--out",
    "out",
];

fn case(b: &Bench, from: &str, to: &str) {
    assert!(CASE.contains(from), "{from}");
    b.write("truth.toml", truth());
    b.write("case.toml", CASE.replacen(from, to, 1));
}

fn simulate(
    id: &'static str,
    fault: &'static str,
    spoil: fn(&Bench),
    exit: i32,
    says: &'static [&'static str],
) -> Row {
    row(id, fault, spoil, exit, says).run(SIMULATE)
}

fn kim(fault: &'static str, spoil: fn(&Bench), says: &'static [&'static str]) -> Row {
    row("kim2010", fault, spoil, 2, says).more(&[
        "--method",
        "kim2010",
        "--variant",
        "conventional",
    ])
}

fn ma(fault: &'static str, spoil: fn(&Bench), says: &'static [&'static str]) -> Row {
    row("ma2008", fault, spoil, 2, says).more(&["--method", "ma2008"])
}

/// An arm of one link on the satellite.
fn arm(b: &Bench, mass: &str, more: &str) {
    let text = MODEL.replace("estimate = [\"inertia\"]", "estimate = true")
        + "\n[[body]]\nname = \"link\"\nmass_kg = "
        + mass
        + "\ncom_m = [0.2, 0.0, 0.0]\ninertia_kg_m2 = { xx = 0.1, yy = 0.1, zz = 0.1 }\n\n[[joint]]\nname = \"j\"\ntype = \"revolute\"\nparent = \"bus\"\nchild = \"link\"\norigin_m = [0.5, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n\n[[sensor]]\nname = \"v\"\ntype = \"velocity\"\nnoise_m_s = 1e-5\n"
        + more;
    b.write("m.toml", text);
    b.spoil(|s| {
        s.header
            .extend(["j_rad", "v_x", "v_y", "v_z"].map(str::to_owned));
        for (k, row) in s.rows.iter_mut().enumerate() {
            let t = k as f64 / 5.0;
            row.push(format!("{:?}", (0.1 * t).sin()));
            row.extend([0.01, 0.02, 0.03].map(|v: f64| format!("{v:?}")));
        }
    });
}

/// A column and its values as a function of time.
pub type Column = (&'static str, fn(f64) -> f64);

/// A robot of three bodies without wheels, with the `estimate` of each body and columns as functions of time.
pub fn robot(b: &Bench, estimate: [&str; 3], more: &str, columns: &[Column]) {
    let (head, _) = MODEL.split_once("[[wheel]]").unwrap();
    let (_, tail) = MODEL.split_once("[[sensor]]").unwrap();
    let head = head.replace("estimate = [\"inertia\"]", estimate[0]);
    let link = |name: &str, estimate: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass_kg = 10.0\ncom_m = [0.2, 0.1, 0.0]\ninertia_kg_m2 = {{ xx = 0.2, yy = 0.2, zz = 0.2 }}\n{estimate}\n\n"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "[[joint]]\nname = \"{name}\"\ntype = \"revolute\"\nparent = \"{parent}\"\nchild = \"{child}\"\norigin_m = [0.5, 0.0, 0.0]\naxis = [0.0, 0.0, 1.0]\n\n"
        )
    };
    let text = head
        + &link("upper", estimate[1])
        + &link("lower", estimate[2])
        + &joint("j1", "bus", "upper")
        + &joint("j2", "upper", "lower")
        + "[[sensor]]\nname = \"v\"\ntype = \"velocity\"\nnoise_m_s = 1e-5\n\n[[sensor]]"
        + tail
        + more;
    b.write("m.toml", text);
    b.write("t.csv", moving(columns));
}

/// Telemetry without wheels and with these columns.
pub fn moving(columns: &[Column]) -> String {
    let mut s = crate::bad_input::bench::sheet();
    s.without("wheel");
    s.header.extend(columns.iter().map(|c| c.0.to_owned()));
    for (k, row) in s.rows.iter_mut().enumerate() {
        let t = k as f64 / 5.0;
        row.extend(columns.iter().map(|c| format!("{:?}", c.1(t))));
    }
    s.text()
}

pub const THRUSTER: &str = "\n[[thruster]]\nname = \"thr\"\nbody = \"bus\"\nposition_m = [0.0, 0.3, 0.0]\nforce_direction = [1.0, 0.0, 0.0]\n";
pub const ALL: &str = "estimate = true";
pub const DRIFT: [Column; 3] = [("v_x", |_| 0.01), ("v_y", |_| 0.02), ("v_z", |_| 0.03)];

/// Columns of a drifting robot and of its joints.
fn with(more: &[Column]) -> Vec<Column> {
    DRIFT.iter().chain(more).copied().collect()
}

fn xu(
    id: &'static str,
    fault: &'static str,
    spoil: fn(&Bench),
    says: &'static [&'static str],
) -> Row {
    row(id, fault, spoil, 2, says).more(&["--method", "xu2017", "--variant", "linear"])
}

fn xu2017() -> Vec<Row> {
    vec![
        xu("E0531", "momentum wheels", |b| b.model("estimate = [\"inertia\"]", ALL), &["E0531 wheel 'wheel1': xu2017 knows no momentum wheels; take it out of the model if it stands still, or use --method auto"]),
        xu("E0532", "the mass of one body alone", |b| robot(b, ["estimate = [\"mass\"]", "", ""], "", &with(&[("j1_rad", f64::sin)])), &["E0532 body 'bus': estimate: xu2017 takes a body as known, as unknown (estimate = true), or with known mass and mass centre (estimate = [\"inertia\"]); change it, or use --method auto"]),
        xu("E0533", "nothing known and no thrust", |b| robot(b, [ALL; 3], "", &with(&[("j1_rad", f64::sin)])), &["E0533 no thruster fires with the joints locked, and no body fixes the scale", "; add a segment with thrust, take estimate out of the base or the arm, or use --method auto"]),
        xu("E0534", "no velocity", |b| robot(b, ["", ALL, ""], "", &[("j1_rad", f64::sin)]), &["E0534 segment 't.csv': no velocity channel (v_x v_y v_z): xu2017 needs it for the momentum of a moving joint; add it, or use --method auto"]),
        xu("E0535", "two joints at once", |b| robot(b, ["", ALL, ALL], "", &with(&[("j1_rad", f64::sin), ("j2_rad", f64::cos)])), &["E0535 segment 't.csv': joints j1, j2 move together: xu2017 unlocks one joint at a time unless a single body is unknown; split the motion, or use --method auto"]),
        xu("E0536", "thrust while a joint moves", |b| robot(b, ["", ALL, ""], THRUSTER, &with(&[("j1_rad", f64::sin), ("thr_N", |_| 1.0)])), &["E0536 segment 't.csv': a thruster fires while joint 'j1' moves: xu2017 takes momentum as conserved then; cut the firing out, or use --method auto"]),
        xu("E0537", "a locked joint left elsewhere", |b| {
            robot(b, ["", ALL, ALL], "", &with(&[("j1_rad", f64::sin), ("j2_rad", |_| 0.0)]));
            b.write("u.csv", moving(&with(&[("j1_rad", f64::sin), ("j2_rad", |_| 0.5)])));
        }, &["E0537 segment 'u.csv': joint 'j2' is locked at 0.5, elsewhere at 0 (rad or m): (43)-(46) need one normal configuration in all segments; bring the joint back, or use --method auto"]).run(&["identify", "--model", "m.toml", "--telemetry", "t.csv", "--telemetry", "u.csv", "--out", "out"]),
        row("E0538", "the swarm on a drifting robot", |b| robot(b, ["", ALL, ""], "", &with(&[("j1_rad", f64::sin)])), 2, &["E0538 segment 't.csv': the vehicle moves at", "the objective (52) assumes zero momentum, so variant swarm must start at rest; use --variant linear, which takes the momentum as unknown"]).more(&["--method", "xu2017"]),
        xu("E0539", "nothing moves and nothing fires", |b| robot(b, ["", ALL, ""], "", &DRIFT), &["E0539 no segment has thrust with the joints locked, and in none does a joint move: xu2017 has nothing to work on; fire thrusters or drive a joint, or use --method auto"]),
        xu("E0306", "an angular acceleration of 1e300 rad/s2", |b| robot(b, [ALL; 3], THRUSTER, &with(&[("domega_x", |_| 1.0e300), ("domega_y", |_| 0.0), ("domega_z", |_| 0.0), ("thr_N", |_| 1.0)])), &["E0306 t.csv: channel 'domega_x': 1e300 at t = 0 s: beyond 1e6 rad/s2"]),
    ]
}

const VALIDATE: &[&str] = &[
    "validate",
    "--against",
    "truth.toml",
    "case.toml",
    "--out",
    "sim",
];

fn validate() -> Vec<Row> {
    vec![
        row("E0701", "an estimate that is not there", |b| case(b, "seed = 3", "seed = 3"), 2, &["E0701 nowhere: this estimate cannot be simulated: there is no such file; give the folder of identify --out"]).run(VALIDATE).more(&["--estimate", "nowhere"]),
        row("E0702", "a controlled case", |b| {
            let (head, _) = CASE.split_once("[[wheel_motion]]").unwrap();
            b.write("truth.toml", truth());
            b.write("case.toml", head.to_owned() + "[control]\nnatural_frequency_rad_s = 0.04\ndamping_ratio = 0.7\n\n[output]\nrate_hz = 5\n");
        }, 2, &["E0702 case.toml: [control] would command different torques on the two vehicles; prescribe wheel torques with [[wheel_motion]]"]).run(VALIDATE),
        row("E0703", "telemetry from after the case", |b| {
            case(b, "seed = 3", "seed = 3");
            b.spoil(|s| s.map("time_s", |_, t| t + 1000.0));
        }, 2, &["E0703 case.toml: the telemetry has no attitude, rate, position, velocity, acceleration or joint sample during the case; give telemetry with times from the start of the case"]).run(&["validate", "--against", "t.csv", "case.toml", "--out", "sim"]),
    ]
}

const CAMPAIGN: &[&str] = &["campaign", "plan.toml", "--out", "c"];
const PLAN: &str = "schema = \"poinsot.plan/1\"\ntrials = 4\n\n[[experiment]]\ncase = \"case.toml\"\n\n[[vary]]\nnumber = \"gyro.noise\"\nvalues = [1.0, 2.0]\n";

fn plan(b: &Bench, from: &str, to: &str) {
    assert!(PLAN.contains(from), "{from}");
    case(b, "seed = 3", "seed = 3");
    b.write("plan.toml", PLAN.replacen(from, to, 1));
}

/// Faults that prevent a campaign.
fn campaigns() -> Vec<Row> {
    let of = |id, fault, spoil: fn(&Bench), says| row(id, fault, spoil, 2, says).run(CAMPAIGN);
    vec![
        of(
            "E0541",
            "a key of a plan that does not exist",
            |b| plan(b, "trials", "trails"),
            &["E0541 plan.toml:2: unknown field `trails`; did you mean \"trials\"?"],
        ),
        of(
            "E0541",
            "a value of a plan that makes a model impossible",
            |b| plan(b, "gyro.noise\"\nvalues = [1.0", "bus.mass_kg\"\nvalues = [-1.0"),
            &["E0115 truth.toml:7:11: body[0].mass_kg (body \"bus\") = -1.0: the mass is negative"],
        ),
        of(
            "E0542",
            "an address of a plan that names nothing",
            |b| plan(b, "gyro.noise", "giro.noise"),
            &["E0542 plan.toml:8: vary[0].number = \"giro.noise\": no sensor \"giro\" that declares noise (experiment case); did you mean \"gyro\"?"],
        ),
        of(
            "E0602",
            "shards of another plan",
            |b| {
                plan(b, "trials = 4", "trials = 5");
                std::fs::create_dir_all(b.path("c/shards/000000")).unwrap();
                b.write("c/shards/000000/0123456789ab_000000000.json", "{}");
            },
            &["E0602 c/shards/000000/0123456789ab_000000000.json: this is a shard of plan 0123456789ab"],
        ),
        of(
            "E0603",
            "a merge of shards that are not there",
            |b| plan(b, "trials = 4", "trials = 5"),
            &["E0603", "shard 0 cannot be merged: it is not there (2 of 2 shards are missing); run the campaign with --resume"],
        )
        .more(&["--merge"]),
    ]
}

pub fn rows() -> Vec<Row> {
    let mut all = campaigns();
    all.extend(vec![
        row("E0001", "a method that does not exist", |_| {}, 2, &["E0001 --method 'best': there is no such method; use one of auto, linear, maximum_likelihood, kim2010, ma2008"]).more(&["--method", "best"]),
        row("E0001", "a policy that does not exist", |_| {}, 2, &["E0001 --policy 'lag=exclude': lag has no such policy; use one of report, refuse"]).more(&["--policy", "lag=exclude"]),
        row("E0001", "a code that does not exist", |_| {}, 2, &["E0001 explain 'E9999': there is no such code; run `poinsot explain` for all"]).run(&["explain", "E9999"]),
        row("E0001", "an accuracy of zero", |_| {}, 2, &["E0001 --relative-accuracy '0': must be a positive number; give for example 1.0"]).more(&["--relative-accuracy", "0"]),
        row("usage", "an option that does not exist", |_| {}, 2, &["error: unexpected argument '--nmae' found"]).more(&["--nmae"]),
        row("E0002", "a file stands where the folder should go", |b| b.write("out", ""), 3, &["E0002 out: a folder is needed here: ", "; move the file at this path, or name another folder"]),
        row("E0210", "two files with the same channel", |b| { let t = std::fs::read(b.path("t.csv")).unwrap(); b.write("u.csv", t); }, 2, &["E0210 channel 'omega_x' is in t.csv column 'omega_x' and again in u.csv column 'omega_x'; leave one out, or name the sensors: '<sensor>.omega_x'"]).run(TWO),
        row("E0303", "files that do not overlap", |b| { b.spoil(|s| s.without("wheel")); let mut w = crate::bad_input::bench::sheet(); w.without("q_"); w.without("omega"); w.map("time_s", |_, t| t + 1000.0); b.write("u.csv", w.text()); }, 2, &["E0303 t.csv,u.csv: 0 samples have all required channels at one time, but 2 are required; give a longer record, or files whose times overlap"]).run(TWO),
        row("E0211", "an unknown unit", |b| b.write("m.toml", MODEL.to_owned() + "\n[telemetry.columns]\nomega_x = { column = \"omega_x\", unit = \"rad/ss\" }\n"), 2, &["E0211 m.toml:", "unit 'rad/ss' is not known; did you mean 'rad/s'?"]),
        row("E0212", "a map to a column that is not there", |b| b.write("m.toml", MODEL.to_owned() + "\n[telemetry.columns]\nomega_x = { column = \"wx\", unit = \"rad/s\" }\n"), 2, &["E0212 map of channel 'omega_x': no column 'wx' in t.csv; "]),
        row("E0213", "rows chosen by a text that is not there", |b| b.write("m.toml", MODEL.to_owned() + "\n[telemetry]\nwhere = { omega_x = \"A\" }\n"), 2, &["E0213 where omega_x = 'A': no row of t.csv matches; choose among the values there, the first are"]),
        row("E0304", "absolute orbital positions", |b| { b.model("[momentum]", "[[sensor]]\nname = \"gps\"\ntype = \"position\"\nnoise_m = 1.0\n\n[momentum]"); b.spoil(|s| { s.header.extend(["r_x", "r_y", "r_z"].map(str::to_owned)); s.rows.iter_mut().for_each(|r| r.extend(["7000000.0", "0.0", "0.0"].map(str::to_owned))); }); }, 2, &["E0304 t.csv: channel 'r': |r| = 7e6 m at t = 0 s"]),
        row("E0305", "a gyro on a link", |b| { arm(b, "10.0", ""); b.model("type = \"gyro\"", "type = \"gyro\"\nbody = \"link\""); }, 2, &["E0305 model: sensor 'gyro' is on body 'link'"]),
        row("E0307", "known momentum and no attitude", |b| { b.spoil(|s| s.without("q_")); b.model("angular_N_m_s = \"estimate\"", "angular_N_m_s = [0.2, -0.3, 0.25]"); }, 2, &["E0307 t.csv: no attitude channel (q_x q_y q_z q_w), but [momentum] angular_N_m_s = [0.2, -0.3, 0.25] in the axes of N"]),
        row("E0401", "the mass centre alone, linear", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replace("estimate = true", "estimate = [\"com\"]"); b.write("m.toml", m); }, 2, &["E0401 body 'bus': estimate has the mass centre but not the inertia"]).more(&["--method", "linear"]),
        row("E0402", "nothing to estimate", |b| b.model("estimate = [\"inertia\"]\n", ""), 2, &["E0402 the model has nothing to estimate: every body is known; set estimate = true on at least one body"]),
        row("E0403", "several bodies without velocity, linear", |b| { arm(b, "10.0", ""); b.spoil(|s| { s.header.push("j_rad".into()); s.rows.iter_mut().enumerate().for_each(|(k, r)| r.push(format!("{:?}", (0.02 * k as f64).sin()))); }); }, 2, &["E0403 no velocity (channels v_x v_y v_z"]).more(&["--method", "linear"]),
        row("E0405", "a body without inertia to speak of", |b| b.model("xx = 15.0, yy = 16.0, zz = 21.0", "xx = 1e-9, yy = 1e-9, zz = 1e-9"), 2, &["E0405 the motion cannot be predicted from the nominal mass properties"]),
        row("E0601", "a report of nothing", |_| {}, 2, &["E0601 out/estimate.json: no report or export can be made of this: it is not there; write it by `poinsot identify --out DIR`"]).run(&["report", "out"]),
        row("E0601", "an export of nothing", |b| b.write("r.urdf", crate::bad_input::models::ROBOT), 2, &["E0601 out/estimate.json"]).run(&["export", "out", "--to", "urdf", "--onto", "r.urdf"]),
        kim("a body that never turns about x", |b| b.spoil(|s| { s.map("omega_x", |_, _| 0.0); s.map("q_", |_, _| 0.5); }), &["E0422 kim2010: the body never turns about its x axis"]),
        kim("wheels at rest", |b| b.spoil(|s| s.map("wheel", |_, _| 0.0)), &["E0423 kim2010: the wheel momentum never changes"]),
        kim("wheels of 1e30 kg m2", |b| { let m = MODEL.replace("0.0004113", "1e30"); b.write("m.toml", m); }, &["E0424 kim2010: the telemetry holds numbers that are not finite or overflow"]),
        kim("two samples", |b| b.spoil(|s| s.rows.truncate(2)), &["E0421 kim2010: fewer than three samples; give a longer record"]),
        kim("a vehicle of two bodies", |b| arm(b, "10.0", ""), &["E0425 kim2010 is for one rigid body with wheels and no external torque"]),
        ma("a vehicle without arm", |b| b.model("estimate = [\"inertia\"]", "estimate = true"), &["E0523 model: the bodies beyond the base 'bus' have no mass"]),
        ma("a link to estimate", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replace("com_m = [0.2", "estimate = true\ncom_m = [0.2"); b.write("m.toml", m); }, &["E0521 body 'link': estimate: ma2008 needs every body but the base known"]),
        ma("the inertia alone", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replace("estimate = true", "estimate = [\"inertia\"]"); b.write("m.toml", m); }, &["E0522 body 'bus': estimate: ma2008 identifies mass, mass centre and inertia of the base together"]),
        row("ma2008", "momentum known but not given", |b| arm(b, "10.0", ""), 2, &["E0524 [momentum]"]).more(&["--method", "ma2008", "--variant", "known-momentum"]),
        ma("no velocity", |b| { arm(b, "10.0", ""); b.spoil(|s| { s.header.push("j_rad".into()); s.rows.iter_mut().enumerate().for_each(|(k, r)| r.push(format!("{:?}", (0.02 * k as f64).sin()))); }); }, &["E0525 segment 't.csv': no velocity channel (v_x v_y v_z)"]),
        ma("a wheel to estimate", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replacen("spin_inertia_kg_m2 = 0.0004113", "spin_inertia_kg_m2 = 0.0004113\nestimate = true", 1); b.write("m.toml", m); }, &["E0527 wheel 'wheel1': estimate"]),
        ma("a thruster fires", |b| { arm(b, "10.0", "\n[[thruster]]\nname = \"thr\"\nbody = \"bus\"\nposition_m = [0.0, 0.0, 0.0]\nforce_direction = [1.0, 0.0, 0.0]\n"); let t = std::fs::read_to_string(b.path("t.csv")).unwrap(); let t: Vec<String> = t.lines().enumerate().map(|(k, l)| if k == 0 { format!("{l},thr_N") } else { format!("{l},1.0") }).collect(); b.write("t.csv", t.join("\n") + "\n"); }, &["E0526 segment 't.csv': a thruster fires"]),
        ma("a base of 1e-300 kg with a link of 1e30 kg", |b| { arm(b, "1e30", ""); b.model("mass_kg = 150.0", "mass_kg = 1e-300"); }, &["E0108 m.toml:", "the mass is below 1e-12 kg; correct it"]),
        ma("two samples", |b| { arm(b, "10.0", ""); let t = std::fs::read_to_string(b.path("t.csv")).unwrap(); let t: Vec<&str> = t.lines().take(3).collect(); b.write("t.csv", t.join("\n") + "\n"); }, &["E0528 segment 't.csv'"]),
    ]);
    all.extend(cases());
    all.extend(xu2017());
    all.extend(validate());
    all
}

fn cases() -> Vec<Row> {
    vec![
        simulate(
            "E0501",
            "no such case",
            |_| {},
            2,
            &["E0501 case.toml: there is no such file; check the path"],
        ),
        simulate(
            "E0502",
            "a case that is not TOML",
            |b| case(b, "duration_s = 100.0", "duration_s = "),
            2,
            &["E0502 case.toml:3"],
        ),
        simulate(
            "E0503",
            "a model as the case",
            |b| case(b, "poinsot.case/1", "poinsot.model/1"),
            2,
            &[
                "E0503 case.toml:1: schema = \"poinsot.model/1\": this is not the format of a case; write schema = \"poinsot.case/2\"",
            ],
        ),
        simulate(
            "E0504",
            "a wheel that is not there",
            |b| case(b, "wheel = \"wheel1\"", "wheel = \"wheel9\""),
            2,
            &["E0504 case.toml:", "did you mean \"wheel"],
        ),
        simulate(
            "E0505",
            "a negative duration",
            |b| case(b, "duration_s = 100.0", "duration_s = -100.0"),
            2,
            &["E0505 case.toml:3: duration_s = -100.0"],
        ),
        simulate(
            "E0506",
            "times and values of other lengths",
            |b| {
                case(
                    b,
                    "time_s = [0.0, 30.0, 60.0, 100.0]",
                    "time_s = [0.0, 30.0, 60.0]",
                )
            },
            2,
            &["E0506 case.toml:"],
        ),
        simulate(
            "E0507",
            "speed and torque for one wheel",
            |b| {
                case(
                    b,
                    "speed_rad_s = [20.0, -100.0, 130.0, -50.0]",
                    "speed_rad_s = [20.0, -100.0, 130.0, -50.0]\ntorque_N_m = [0.0, 0.0, 0.0, 0.0]",
                )
            },
            2,
            &["E0507 case.toml:"],
        ),
        simulate(
            "E0508",
            "a controller beside joint torques",
            |b| {
                let more = "[control]\nnatural_frequency_rad_s = 0.04\ndamping_ratio = 0.7\n\n[[joint_torque]]\njoint = \"j\"\nconstant_N_m = 1.0\n\n[output]";
                case(b, "[output]", more);
            },
            2,
            &[
                "E0508 case.toml:",
                "the simulation does not support this with [control]",
            ],
        ),
        simulate(
            "E0511",
            "a torque table that is not there",
            |b| {
                let mut m = CASE.replacen(
                    "[output]",
                    "[[joint_torque]]\njoint = \"j\"\nfile = \"none.csv\"\n\n[output]",
                    1,
                );
                m = m.replace("truth.toml", "m.toml");
                arm(b, "10.0", "");
                b.write("case.toml", m);
            },
            2,
            &["E0511 case.toml:"],
        ),
        simulate(
            "E0509",
            "a torque on a link that nothing resists",
            |b| {
                let torque = "[[joint_torque]]\njoint = \"j\"\nconstant_N_m = 1.0\n\n[output]";
                let text = CASE.replacen("[output]", torque, 1);
                arm(b, "10.0", "");
                b.model(
                    "com_m = [0.2, 0.0, 0.0]\ninertia_kg_m2 = { xx = 0.1, yy = 0.1, zz = 0.1 }",
                    "com_m = [0.0, 0.0, 0.0]\ninertia_kg_m2 = { xx = 0.0, yy = 0.0, zz = 0.0 }",
                );
                b.write("case.toml", text.replace("truth.toml", "m.toml"));
            },
            2,
            &[
                "E0509 case.toml: joint \"j\" moves by torque or spring, but its outboard bodies have no inertia about its axis (singular mass matrix); give them mass off the axis or inertia about it, or prescribe its motion with [[joint_motion]]",
            ],
        ),
        simulate(
            "E0219",
            "a momentum of 1e308 N s",
            |b| {
                let drift = "linear_N_s = [1e308, 0.0, 0.0]";
                let position = "\n[[sensor]]\nname = \"p\"\ntype = \"position\"\nnoise_m = 0.1\n";
                let text = CASE
                    .replace("linear_N_s = [0.0, 0.0, 0.0]", drift)
                    .replace("duration_s = 100.0", "duration_s = 1e5")
                    .replace("rate_hz = 5", "rate_hz = 0.001");
                b.write("truth.toml", truth() + position);
                b.write("case.toml", text);
            },
            2,
            &[
                "E0219 sim/telemetry.csv column 'r_x': a value is not finite; correct what it comes from, or leave the sample out",
            ],
        ),
        simulate(
            "E0002",
            "a file stands where the folder should go",
            |b| {
                case(b, "seed = 3", "seed = 3");
                b.write("sim", "");
            },
            3,
            &[
                "E0002 sim: a folder is needed here: ",
                "; move the file at this path",
            ],
        ),
    ]
}

/// Messages that no input of the command can cause, with the reason: bugs, and checks of the library for callers whose
/// numbers the command would have rejected.
pub fn of_the_library() -> Vec<(&'static str, String, &'static str)> {
    use poinsot_identify::{EvaluationError, ProblemError};
    use poinsot_papers::{kim2010, ma2008::Ma2008Error, xu2017::Xu2017Error};
    let fault = poinsot::Error::Internal {
        what: "index out of range (src/x.rs:1)".to_owned(),
    };
    let short = ProblemError::TooFewSamples {
        label: "t.csv".to_owned(),
        samples: 1,
    };
    let overflow = ProblemError::NotFinite(poinsot_identify::NotFinite);
    let threads = poinsot::Error::Threads {
        why: "Resource temporarily unavailable (os error 11)".to_owned(),
    };
    let kept = poinsot::Error::Kept {
        path: "out/report_data.json".into(),
        source: std::io::ErrorKind::StorageFull.into(),
        kept: "out/.poinsot-a1B2c3".into(),
    };
    let length = EvaluationError::Length {
        what: "values of the unknowns".to_owned(),
        found: 11,
        expected: 12,
    };
    vec![
        (
            "E0004",
            kept.to_string(),
            "only where a disk fails between two renames: tests/all/environment",
        ),
        (
            "E0005",
            threads.to_string(),
            "only where the system refuses: tests/all/environment",
        ),
        (
            "E0006",
            poinsot::Error::Memory.to_string(),
            "only where the system refuses: tests/all/environment",
        ),
        (
            "E0009",
            fault.to_string(),
            "only where the program has a fault",
        ),
        (
            "E0404",
            short.to_string(),
            "only by the library: the program says E0303 before",
        ),
        (
            "E0410",
            overflow.to_string(),
            "only by the library: the program says E0306 or E0108 before",
        ),
        (
            "E0411",
            length.to_string(),
            "only by the library: the program makes all arrays from one table",
        ),
        (
            "E0529",
            Ma2008Error::NotFinite.to_string(),
            "only by the library: the program says E0108 before",
        ),
        (
            "E0420",
            kim2010::Kim2010Error::Lengths.to_string(),
            "only by the library: the program gives every channel the same times",
        ),
        (
            "E0540",
            Xu2017Error::NotFinite.to_string(),
            "only by the library: the program says E0306 before",
        ),
    ]
}
