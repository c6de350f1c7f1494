//! Codes that the list of faults does not reach: each is provoked once.

use crate::bench::{Bench, CASE, MODEL, truth};
use crate::row::{Row, row};

const SIMULATE: &[&str] = &["simulate", "case.toml", "--out", "sim"];
const TWO: &[&str] = &[
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

pub fn rows() -> Vec<Row> {
    let mut all = vec![
        row("E0001", "a method that does not exist", |_| {}, 2, &["E0001 --method 'best': known methods: auto, linear, maximum_likelihood, kim2010, ma2008"]).more(&["--method", "best"]),
        row("E0001", "a policy that does not exist", |_| {}, 2, &["E0001 --policy 'lag=exclude': policies of lag: report, refuse"]).more(&["--policy", "lag=exclude"]),
        row("E0001", "a code that does not exist", |_| {}, 2, &["E0001 explain 'E9999': there is no such code; `poinsot explain` lists all"]).run(&["explain", "E9999"]),
        row("E0001", "an accuracy of zero", |_| {}, 2, &["E0001 --relative-accuracy '0': a positive number is needed, for example 1.0"]).more(&["--relative-accuracy", "0"]),
        row("usage", "an option that does not exist", |_| {}, 2, &["error: unexpected argument '--nmae' found"]).more(&["--nmae"]),
        row("E0002", "a file stands where the folder should go", |b| b.write("out", ""), 3, &["E0002 out/report_data.json: its folder cannot be made: "]),
        row("E0210", "two files with the same channel", |b| { let t = std::fs::read(b.path("t.csv")).unwrap(); b.write("u.csv", t); }, 2, &["E0210 channel 'omega_x' stands in t.csv column 'omega_x' and again in u.csv column 'omega_x'; leave one out, or name the sensors: '<sensor>.omega_x'"]).run(TWO),
        row("E0303", "files that do not overlap", |b| { b.spoil(|s| s.without("wheel")); let mut w = crate::bench::sheet(); w.without("q_"); w.without("omega"); w.map("time_s", |_, t| t + 1000.0); b.write("u.csv", w.text()); }, 2, &["E0303 t.csv,u.csv: 0 samples have all needed channels at one time; at least 2 are needed"]).run(TWO),
        row("E0211", "an unknown unit", |b| b.write("m.toml", MODEL.to_owned() + "\n[telemetry.columns]\nomega_x = { column = \"omega_x\", unit = \"rad/ss\" }\n"), 2, &["E0211 unit 'rad/ss' is not known; did you mean 'rad/s'?"]),
        row("E0212", "a map to a column that is not there", |b| b.write("m.toml", MODEL.to_owned() + "\n[telemetry.columns]\nomega_x = { column = \"wx\", unit = \"rad/s\" }\n"), 2, &["E0212 map of channel 'omega_x': no column 'wx' in t.csv"]),
        row("E0213", "rows chosen by a text that is not there", |b| b.write("m.toml", MODEL.to_owned() + "\n[telemetry]\nwhere = { omega_x = \"A\" }\n"), 2, &["E0213 where omega_x = 'A': no row of t.csv matches; the first values there are"]),
        row("E0304", "absolute orbital positions", |b| { b.model("[momentum]", "[[sensor]]\nname = \"gps\"\ntype = \"position\"\nnoise_m = 1.0\n\n[momentum]"); b.spoil(|s| { s.header.extend(["r_x", "r_y", "r_z"].map(str::to_owned)); s.rows.iter_mut().for_each(|r| r.extend(["7000000.0", "0.0", "0.0"].map(str::to_owned))); }); }, 2, &["E0304 t.csv: channel 'r': |r| = 7.000e6 m at t = 0 s"]),
        row("E0305", "a gyro on a link", |b| { arm(b, "10.0", ""); b.model("type = \"gyro\"", "type = \"gyro\"\nbody = \"link\""); }, 2, &["E0305 model: sensor 'gyro' sits on body 'link'"]),
        row("E0307", "known momentum and no attitude", |b| { b.spoil(|s| s.without("q_")); b.model("angular_N_m_s = \"estimate\"", "angular_N_m_s = [0.2, -0.3, 0.25]"); }, 2, &["E0307 t.csv: no attitude channel (q_x q_y q_z q_w), but [momentum] angular_N_m_s = [0.2, -0.3, 0.25] in the axes of N"]),
        row("E0401", "the mass centre alone, linear", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replace("estimate = true", "estimate = [\"com\"]"); b.write("m.toml", m); }, 2, &["E0401 body 'bus': estimate asks for the mass centre while the inertia about it is held"]).more(&["--method", "linear"]),
        row("E0402", "nothing to estimate", |b| b.model("estimate = [\"inertia\"]\n", ""), 2, &["E0402 the model has nothing to estimate: every body is given as known; set estimate = true on at least one body"]),
        row("E0403", "several bodies without velocity, linear", |b| { arm(b, "10.0", ""); b.spoil(|s| { s.header.push("j_rad".into()); s.rows.iter_mut().enumerate().for_each(|(k, r)| r.push(format!("{:?}", (0.02 * k as f64).sin()))); }); }, 2, &["E0403 no velocity: no channels v_x v_y v_z"]).more(&["--method", "linear"]),
        row("E0405", "a body without inertia to speak of", |b| b.model("xx = 15.0, yy = 16.0, zz = 21.0", "xx = 1e-9, yy = 1e-9, zz = 1e-9"), 2, &["E0405 the motion cannot be predicted from the nominal mass properties"]),
        row("E0601", "a report of nothing", |_| {}, 2, &["E0601 out/estimate.json: no report can be made of this: it is not there; `poinsot identify --out DIR` writes it"]).run(&["report", "out"]),
        row("E0601", "an export of nothing", |b| b.write("r.urdf", crate::models::ROBOT), 2, &["E0601 out/estimate.json"]).run(&["export", "out", "--to", "urdf", "--onto", "r.urdf"]),
        kim("a body that never turns about x", |b| b.spoil(|s| { s.map("omega_x", |_, _| 0.0); s.map("q_", |_, _| 0.5); }), &["E0422 kim2010: the body never turns about its x axis"]),
        kim("wheels at rest", |b| b.spoil(|s| s.map("wheel", |_, _| 0.0)), &["E0423 kim2010: the momentum of the wheels never changes"]),
        kim("two samples", |b| b.spoil(|s| s.rows.truncate(2)), &["E0421 kim2010: at least three samples are needed"]),
        kim("a vehicle of two bodies", |b| arm(b, "10.0", ""), &["E0425 kim2010 is for one rigid body with wheels and no external torque"]),
        ma("a vehicle without arm", |b| b.model("estimate = [\"inertia\"]", "estimate = true"), &["E0523 model: the bodies beyond the base 'bus' have no mass"]),
        ma("a link to estimate", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replace("com_m = [0.2", "estimate = true\ncom_m = [0.2"); b.write("m.toml", m); }, &["E0521 body 'link': estimate: ma2008 needs every body but the base known"]),
        ma("the inertia alone", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replace("estimate = true", "estimate = [\"inertia\"]"); b.write("m.toml", m); }, &["E0522 body 'bus': estimate: ma2008 identifies mass, mass centre and inertia of the base together"]),
        row("ma2008", "momentum known but not given", |b| arm(b, "10.0", ""), 2, &["E0524 [momentum]"]).more(&["--method", "ma2008", "--variant", "known-momentum"]),
        ma("no velocity", |b| { arm(b, "10.0", ""); b.spoil(|s| { s.header.push("j_rad".into()); s.rows.iter_mut().enumerate().for_each(|(k, r)| r.push(format!("{:?}", (0.02 * k as f64).sin()))); }); }, &["E0525 segment 't.csv': no velocity channel (v_x v_y v_z)"]),
        ma("a wheel to estimate", |b| { arm(b, "10.0", ""); let m = std::fs::read_to_string(b.path("m.toml")).unwrap().replacen("spin_inertia_kg_m2 = 0.0004113", "spin_inertia_kg_m2 = 0.0004113\nestimate = true", 1); b.write("m.toml", m); }, &["E0527 wheel 'wheel1': estimate"]),
        ma("a thruster fires", |b| { arm(b, "10.0", "\n[[thruster]]\nname = \"thr\"\nbody = \"bus\"\nposition_m = [0.0, 0.0, 0.0]\nforce_direction = [1.0, 0.0, 0.0]\n"); let t = std::fs::read_to_string(b.path("t.csv")).unwrap(); let t: Vec<String> = t.lines().enumerate().map(|(k, l)| if k == 0 { format!("{l},thr_N") } else { format!("{l},1.0") }).collect(); b.write("t.csv", t.join("\n") + "\n"); }, &["E0526 segment 't.csv': a thruster fires"]),
        ma("two samples", |b| { arm(b, "10.0", ""); let t = std::fs::read_to_string(b.path("t.csv")).unwrap(); let t: Vec<&str> = t.lines().take(3).collect(); b.write("t.csv", t.join("\n") + "\n"); }, &["E0528 segment 't.csv'"]),
    ];
    all.extend(cases());
    all
}

fn cases() -> Vec<Row> {
    vec![
        simulate(
            "E0501",
            "no such case",
            |_| {},
            2,
            &["E0501 case.toml: No such file or directory"],
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
                "E0503 case.toml:1: schema = \"poinsot.model/1\": this is not the format of a case; write schema = \"poinsot.case/1\"",
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
                "the simulation does not do this yet beside [control]",
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
            "E0510",
            "a file stands where the folder should go",
            |b| {
                case(b, "seed = 3", "seed = 3");
                b.write("sim", "");
            },
            3,
            &["E0510 sim: "],
        ),
    ]
}

/// Messages that the command cannot be made to print: made of the error itself, and why.
pub fn unreachable() -> Vec<(&'static str, String, &'static str)> {
    use poinsot::validate::ValidateError;
    use poinsot_identify::ProblemError;
    use poinsot_identify::methods::{kim2010, ma2008, xu2017::Xu2017Error};
    let label = || "t.csv".to_owned();
    let own = "printed by the tests of the method";
    let case = || "case.toml".into();
    let channel = |name: &str| poinsot_telemetry::Channel {
        name: name.to_owned(),
        sensor: String::new(),
        unit: "rad".to_owned(),
        frame: String::new(),
        time_s: [0.0].into(),
        values: vec![1.0],
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("w.csv");
    let write = poinsot_telemetry::write(&path, &[channel("j_rad"), channel("j_rad")]).unwrap_err();
    vec![
        (
            "E0009",
            poinsot::Error::Internal {
                what: "index out of range (src/x.rs:1)".to_owned(),
            }
            .to_string(),
            "a fault of the program",
        ),
        (
            "E0219",
            write
                .to_string()
                .replace(&format!("{}/", folder.path().display()), ""),
            "simulate makes its own channels",
        ),
        (
            "E0404",
            ProblemError::TooFewSamples {
                label: "t.csv".to_owned(),
                samples: 1,
            }
            .to_string(),
            "E0303 comes before",
        ),
        (
            "E0420",
            kim2010::Kim2010Error::Lengths.to_string(),
            "samples are aligned before",
        ),
        (
            "E0424",
            kim2010::Kim2010Error::NotFinite.to_string(),
            "E0306 comes before",
        ),
        (
            "E0410",
            ProblemError::NotFinite(poinsot_identify::NotFinite).to_string(),
            "E0306 and E0108 come before",
        ),
        (
            "E0531",
            Xu2017Error::Wheel {
                wheel: "wheel1".to_owned(),
            }
            .to_string(),
            own,
        ),
        (
            "E0532",
            Xu2017Error::PartlyKnown {
                body: "bus".to_owned(),
            }
            .to_string(),
            own,
        ),
        ("E0533", Xu2017Error::NoScale.to_string(), own),
        (
            "E0534",
            Xu2017Error::NoVelocity {
                label: label(),
                what: "the first step",
            }
            .to_string(),
            own,
        ),
        (
            "E0535",
            Xu2017Error::JointsTogether {
                label: label(),
                joints: "j1, j2".to_owned(),
            }
            .to_string(),
            own,
        ),
        (
            "E0536",
            Xu2017Error::ThrustInMotion {
                label: label(),
                joint: "j1".to_owned(),
            }
            .to_string(),
            own,
        ),
        (
            "E0537",
            Xu2017Error::OtherConfiguration {
                label: label(),
                joint: "j1".to_owned(),
                found: 0.5,
                expected: 0.0,
            }
            .to_string(),
            own,
        ),
        (
            "E0538",
            Xu2017Error::NotAtRest {
                label: label(),
                rate: 0.1,
                speed: 0.2,
                variant: "swarm",
            }
            .to_string(),
            own,
        ),
        ("E0539", Xu2017Error::NothingMoves.to_string(), own),
        ("E0540", Xu2017Error::NotFinite.to_string(), own),
        (
            "E0701",
            ValidateError::Estimate {
                path: "out".into(),
                why: "it is of another model".to_owned(),
            }
            .to_string(),
            "printed by the tests of validate",
        ),
        (
            "E0702",
            ValidateError::Control { file: case() }.to_string(),
            "printed by the tests of validate",
        ),
        (
            "E0703",
            ValidateError::NothingInCommon { file: case() }.to_string(),
            "printed by the tests of validate",
        ),
        (
            "E0529",
            ma2008::Ma2008Error::NotFinite.to_string(),
            "E0306 comes before",
        ),
    ]
}
