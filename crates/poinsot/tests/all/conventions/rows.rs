//! Conventions of the channels of a record, generated from its model and its channels.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use poinsot_model::Model;
use poinsot_telemetry::{Axes, Channel, Table, full_name};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

pub type Spoil = Box<dyn Fn(&mut Table) + Send + Sync>;

/// A convention of a channel, what is to be said, and how a record is spoilt.
pub struct Row {
    pub kind: &'static str,
    pub channel: String,
    /// Words that all have to be there; those between bars are alternatives.
    said: Vec<String>,
    pub spoil: Spoil,
    /// Whether the record can tell it, as `docs/validation/conventions.md` says.
    pub told: bool,
}

impl Row {
    fn new(kind: &'static str, channel: &str, said: &[&str], spoil: Spoil) -> Self {
        Self {
            kind,
            channel: channel.to_owned(),
            said: said.iter().map(|s| (*s).to_owned()).collect(),
            spoil,
            told: !["held", "orbital", "mass centre"].contains(&kind),
        }
    }

    pub fn is_named_by(&self, text: &str) -> bool {
        let mut words = self.said.iter();
        words.all(|word| word.split('|').any(|either| text.contains(either)))
    }
}

/// Channels that belong together: a value and its rate, or the components of a vector.
struct Owner {
    name: String,
    channels: Vec<String>,
}

fn of<'t>(table: &'t mut Table, names: &[String]) -> impl Iterator<Item = &'t mut Channel> {
    let all = table.channels.iter_mut();
    all.filter(|c| names.contains(&full_name(&c.sensor, &c.name)))
}

pub fn each(names: &[String], change: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Spoil {
    let names = names.to_vec();
    Box::new(move |table| {
        for channel in of(table, &names) {
            channel.values.iter_mut().for_each(|x| *x = change(*x));
        }
    })
}

/// The values of each channel as a whole.
fn whole(names: &[String], change: impl Fn(&mut Vec<f64>) + Send + Sync + 'static) -> Spoil {
    let names = names.to_vec();
    Box::new(move |table| of(table, &names).for_each(|channel| change(&mut channel.values)))
}

pub fn exchange(a: &[String], b: &[String]) -> Spoil {
    let pairs: Vec<(String, String)> = a.iter().cloned().zip(b.iter().cloned()).collect();
    Box::new(move |table| {
        for (a, b) in &pairs {
            let place = |name: &String| {
                let mut all = table.channels.iter();
                all.position(|c| full_name(&c.sensor, &c.name) == *name)
            };
            let (Some(i), Some(j)) = (place(a), place(b)) else {
                continue;
            };
            let (own, other) = (table.channels[i].clone(), table.channels[j].clone());
            (table.channels[i].time_s, table.channels[i].values) = (other.time_s, other.values);
            (table.channels[j].time_s, table.channels[j].values) = (own.time_s, own.values);
        }
    })
}

/// Rows of numbers of a vector, or of a quaternion.
fn rows_of(
    names: &[String],
    change: impl Fn(f64, &mut [f64], &Table) + Send + Sync + 'static,
) -> Spoil {
    let names = names.to_vec();
    Box::new(move |table| {
        let before = table.clone();
        let mut own: Vec<&mut Channel> = of(table, &names).collect();
        own.sort_by_key(|c| {
            let name = full_name(&c.sensor, &c.name);
            names.iter().position(|n| *n == name)
        });
        for k in 0..own[0].values.len() {
            let mut row: Vec<f64> = own.iter().map(|c| c.values[k]).collect();
            change(own[0].time_s[k], &mut row, &before);
            own.iter_mut().zip(row).for_each(|(c, x)| c.values[k] = x);
        }
    })
}

fn vector_of(
    names: &[String],
    change: impl Fn(f64, Vector3<f64>, &Table) -> Vector3<f64> + Send + Sync + 'static,
) -> Spoil {
    rows_of(names, move |t, row, table| {
        let new = change(t, Vector3::from_column_slice(row), table);
        row.copy_from_slice(new.as_slice());
    })
}

/// A number of a channel linearly between its samples.
fn value_at(channel: &Channel, t: f64) -> f64 {
    let last = channel.time_s.len() - 1;
    let k = channel.time_s.partition_point(|s| *s <= t).clamp(1, last);
    let (a, b) = (channel.time_s[k - 1], channel.time_s[k]);
    let s = (t - a) / (b - a);
    channel.values[k - 1] * (1.0 - s) + channel.values[k] * s
}

fn attitude_at(table: &Table, t: f64) -> UnitQuaternion<f64> {
    let [x, y, z, w] =
        ["q_x", "q_y", "q_z", "q_w"].map(|name| value_at(table.channel(name).unwrap(), t));
    UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z))
}

fn rate_at(table: &Table, t: f64) -> Vector3<f64> {
    let numbers =
        ["x", "y", "z"].map(|k| value_at(table.channel(&format!("omega_{k}")).unwrap(), t));
    numbers.into()
}

/// Of two columns beside each other the next one; none behind the last of more than two.
fn exchanges(owners: &[Owner]) -> impl Iterator<Item = Row> {
    owners.windows(2).map(|two| {
        let [a, b] = [&two[0], &two[1]];
        let names = format!("{}, {}", a.name, b.name);
        Row::new(
            "exchange",
            &names,
            &[&a.name, &b.name],
            exchange(&a.channels, &b.channels),
        )
    })
}

/// What can happen to the samples of any sensor: of wheels, joints and thrusters to all together.
fn samples(owner: &Owner) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let held = whole(all, |v| {
        (0..v.len()).for_each(|k| v[k] = v[k - k % 4]);
    });
    let late = samples_late(owner);
    vec![
        Row::new("held", name, &[name, "held|repeated"], held),
        Row::new("late", name, &[name, "lag|late_s"], late),
    ]
}

/// The times of three samples later.
fn samples_late(owner: &Owner) -> Spoil {
    let names = owner.channels.clone();
    Box::new(move |table| {
        for channel in of(table, &names) {
            let late = 3.0 * (channel.time_s[1] - channel.time_s[0]);
            channel.time_s = channel.time_s.iter().map(|t| t + late).collect();
        }
    })
}

/// Signed integers of 16 bits, read as unsigned.
fn unsigned(owner: &Owner, table: &Table) -> Vec<Row> {
    let own = |c: &&Channel| owner.channels.contains(&full_name(&c.sensor, &c.name));
    let either = |c: &&Channel| {
        let v = &c.values;
        v.iter().any(|x| *x > 0.0) && v.iter().any(|x| *x < 0.0)
    };
    let of = |channel: &Channel| {
        let name = full_name(&channel.sensor, &channel.name);
        let most = channel.values.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let step = most / 2.0e4;
        let read = each(std::slice::from_ref(&name), move |x| {
            (x / step).round().rem_euclid(65536.0) * step
        });
        Row::new("unsigned", &name, &[&name, "signed_range"], read)
    };
    let channels = table.channels.iter().filter(own).filter(either);
    channels.map(of).collect()
}

fn joint(owner: &Owner, table: &Table) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let factor = |x: f64| each(all, move |q| q * x);
    let offset = |x: f64| each(&all[..1], move |q| q + x);
    let degrees = 1.0_f64.to_degrees();
    let mut rows = vec![
        Row::new("sign", name, &[name, "sign"], factor(-1.0)),
        Row::new("ratio 3/2", name, &[name, "scale = 0.666667"], factor(1.5)),
        Row::new("ratio 1/2", name, &[name, "scale = 2"], factor(0.5)),
        // Large angles are refused with the same word: no motion can be predicted.
        Row::new("degrees", name, &["unit"], factor(degrees)),
        Row::new("zero 90", name, &[name, "zero"], offset(FRAC_PI_2)),
        Row::new("zero -135", name, &[name, "zero"], offset(-0.75 * PI)),
        Row::new("zero 180", name, &[name, "zero"], offset(PI)),
        Row::new(
            "turn",
            &all[0],
            &[name, "wraps_at"],
            each(&all[..1], |q| q.rem_euclid(TAU)),
        ),
    ];
    if let [_, rate] = &all[..] {
        let of = |x: f64| each(std::slice::from_ref(rate), move |q| q * x);
        rows.push(Row::new("sign", rate, &[rate, "times -1"], of(-1.0)));
        rows.push(Row::new(
            "degrees",
            rate,
            &[rate, "times 0.017453"],
            of(degrees),
        ));
    }
    rows.extend(unsigned(owner, table));
    rows
}

fn wheel(owner: &Owner, table: &Table) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let factor = |x: f64| each(all, move |w| w * x);
    let mut rows = vec![
        Row::new("sign", name, &[name, "sign"], factor(-1.0)),
        Row::new("degrees", name, &["unit"], factor(1.0_f64.to_degrees())),
        Row::new("rpm", name, &[name, "unit"], factor(30.0 / PI)),
    ];
    rows.extend(unsigned(owner, table));
    rows
}

fn thruster(owner: &Owner) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let factor = |x: f64| each(all, move |f| f * x);
    vec![Row::new("reversed", name, &[name], factor(-1.0))]
}

/// Axes in which a vector may be read: of one reversed, of two exchanged, of a quarter turn, of all in another order.
fn axes() -> impl Iterator<Item = (&'static str, Axes)> {
    let kind = |axes: &Axes| {
        let order = axes.axis != Axes::IDENTITY.axis;
        let cyclic = order && (0..3).all(|k| axes.axis[k] != k);
        let back = axes.sign.iter().filter(|s| **s < 0).count();
        let kind = match (order, cyclic, back) {
            (false, _, 1) => "sign",
            (true, false, 0) => "exchange",
            (true, true, 0) => "order",
            (true, false, 1) => "quarter turn",
            _ => return None,
        };
        let moved = (0..3).find(|k| axes.sign[*k] < 0);
        // A quarter turn, not a mirror: the axis that stays keeps its sign.
        let turn = moved.is_none_or(|k| !order || axes.axis[k] != k);
        turn.then_some((kind, *axes))
    };
    Axes::all().filter_map(move |axes| kind(&axes))
}

fn vector(owner: &Owner, said: &str) -> Vec<Row> {
    let of = |(kind, axes): (&'static str, Axes)| {
        let spoil = vector_of(&owner.channels, move |_, v, _| axes.turned(&v));
        Row::new(kind, &format!("{} {axes}", owner.name), &[said], spoil)
    };
    axes().map(of).collect()
}

fn gyro(owner: &Owner, table: &Table) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let time = &table
        .channel("omega_x")
        .or_else(|| {
            let mut all = table.channels.iter();
            all.find(|c| c.name == "omega_x")
        })
        .unwrap()
        .time_s;
    let step = time[1] - time[0];
    let factor = |x: f64| each(all, move |w| w * x);
    let mut rows = vec![
        Row::new(
            "degrees",
            name,
            &["gyro in deg/s|rates|unit"],
            factor(1.0_f64.to_degrees()),
        ),
        Row::new("rpm", name, &["gyro in rpm|rates|unit"], factor(30.0 / PI)),
        Row::new(
            "increments",
            name,
            &["increments = true|increments"],
            whole(all, move |w| {
                let mean = |k: usize| 0.5 * (w[k] + w[k.saturating_sub(1)]);
                *w = (0..w.len()).map(|k| step * mean(k)).collect();
            }),
        ),
    ];
    rows.extend(vector(owner, "body rates = gyro|axes"));
    rows.extend(samples(owner));
    rows.extend(unsigned(owner, table));
    if table.channel("q_w").is_some() {
        let inertial = vector_of(all, |t, w, table| attitude_at(table, t) * w);
        rows.push(Row::new("inertial", name, &["inertial axes"], inertial));
    }
    rows
}

fn attitude(owner: &Owner) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let inverse = each(&all[3..], |w| -w);
    let order = rows_of(all, |_, q, _| q.rotate_right(1));
    let both = rows_of(all, |_, q, _| {
        q[3] = -q[3];
        q.rotate_right(1);
    });
    let mut rows = vec![
        Row::new("inverse", name, &["inertial to body"], inverse),
        Row::new("scalar first", name, &["scalar first"], order),
        Row::new(
            "inverse, scalar first",
            name,
            &["scalar first", "inertial to body"],
            both,
        ),
    ];
    let every: Vec<String> = ["omega_x", "omega_y", "omega_z"]
        .map(str::to_owned)
        .to_vec();
    let rate = 1.08e-3;
    let turn = move |t: f64| UnitQuaternion::from_axis_angle(&-Vector3::y_axis(), rate * t);
    let of_rates = vector_of(&every, move |t, w, table| {
        let q = turn(t).inverse() * attitude_at(table, t);
        w + q.inverse() * Vector3::y() * rate
    });
    let of_attitude = rows_of(all, move |t, q, _| {
        let own = UnitQuaternion::new_normalize(Quaternion::new(q[3], q[0], q[1], q[2]));
        let new = turn(t).inverse() * own;
        q.copy_from_slice(&[new.i, new.j, new.k, new.w]);
    });
    rows.push(Row::new(
        "orbital",
        name,
        &["orbital"],
        Box::new(move |table| {
            of_rates(table);
            of_attitude(table);
        }),
    ));
    rows.extend(samples(owner));
    rows
}

/// Position and velocity.
fn place(owner: &Owner, table: &Table, com: Vector3<f64>) -> Vec<Row> {
    let (name, all) = (owner.name.as_str(), &owner.channels);
    let factor = |x: f64| each(all, move |r| r * x);
    let mut rows = vec![
        Row::new(
            "thousandth",
            name,
            &[&format!("the {name}|{}", all[0]), "times|unit|thousand"],
            factor(1.0e-3),
        ),
        Row::new(
            "thousandfold",
            name,
            &[&format!("the {name}|{}", all[0]), "times|unit|thousand"],
            factor(1.0e3),
        ),
    ];
    rows.extend(vector(owner, "the velocity in the axes|axes"));
    rows.extend(samples(owner));
    rows.extend(unsigned(owner, table));
    let moving = name == "velocity";
    if table.channel("q_w").is_some() {
        let body = vector_of(all, |t, v, table| attitude_at(table, t).inverse() * v);
        rows.push(Row::new("body axes", name, &[name, "body axes"], body));
        if com.norm() > 0.0 {
            let of = vector_of(all, move |t, r, table| {
                let arm = if moving {
                    rate_at(table, t).cross(&com)
                } else {
                    com
                };
                r + attitude_at(table, t) * arm
            });
            rows.push(Row::new("mass centre", name, &["mass centre"], of));
        }
    }
    rows
}

/// Whether the zero of a joint is a choice of the axes of the body that it carries: all of that is unknown, and it carries nothing. No
/// data show it; the answer lists it as assumed.
fn chooses_axes(model: &Model, joint: &str) -> bool {
    let own = model.joints.iter().find(|j| j.name == joint);
    own.is_some_and(|own| {
        let asked = model.bodies[own.child].estimate;
        let carries = model.joints.iter().any(|j| j.parent == own.child);
        asked.mass && asked.com && asked.inertia && !carries
    })
}

/// Each convention of each channel of a record.
pub fn generated(model: &Model, table: &Table) -> Vec<Row> {
    let has = |name: &String| {
        let mut all = table.channels.iter();
        all.any(|c| full_name(&c.sensor, &c.name) == *name)
    };
    let owner = |name: &str, channels: Vec<String>| {
        let channels: Vec<String> = channels.into_iter().filter(has).collect();
        (!channels.is_empty()).then(|| Owner {
            name: name.to_owned(),
            channels,
        })
    };
    let joints = model.joints.iter().filter_map(|j| {
        owner(
            &j.name,
            ["rad", "rad_s"]
                .map(|unit| format!("{}_{unit}", j.name))
                .to_vec(),
        )
    });
    let wheels = model.wheels.iter();
    let wheels = wheels.filter_map(|w| owner(&w.name, vec![format!("{}_rad_s", w.name)]));
    let fires = |t: &Owner| {
        let channel = table.channel(&t.channels[0]);
        channel.is_some_and(|c| c.values.iter().any(|f| *f != 0.0))
    };
    let thrusters = model.thrusters.iter();
    let thrusters = thrusters.filter_map(|t| owner(&t.name, vec![format!("{}_N", t.name)]));
    let [joints, wheels]: [Vec<Owner>; 2] = [joints.collect(), wheels.collect()];
    let thrusters: Vec<Owner> = thrusters.filter(fires).collect();
    let mut rows: Vec<Row> = Vec::new();
    let of_joints = joints.iter().flat_map(|o| joint(o, table));
    rows.extend(
        of_joints.filter(|r| !(r.kind.starts_with("zero") && chooses_axes(model, &r.channel))),
    );
    rows.extend(wheels.iter().flat_map(|o| wheel(o, table)));
    rows.extend(thrusters.iter().flat_map(thruster));
    for (name, owners) in [
        ("joints", &joints),
        ("wheels", &wheels),
        ("thrusters", &thrusters),
    ] {
        rows.extend(exchanges(owners));
        let all = Owner {
            name: name.to_owned(),
            channels: owners.iter().flat_map(|o| o.channels.clone()).collect(),
        };
        match name {
            _ if owners.is_empty() => {}
            "thrusters" => {
                let factor = each(&all.channels, |f| 1.0e3 * f);
                rows.push(Row::new("mN", "thrusters", &["thousand|mN"], factor));
                rows.push(Row::new(
                    "late",
                    name,
                    &["lag of|late_s|delayed thrust"],
                    samples_late(&all),
                ));
            }
            _ => rows.extend(samples(&all)),
        }
    }
    for first in &table.channels {
        let Some(prefix) = first.name.strip_suffix("_x") else {
            continue;
        };
        let axes: &[&str] = if prefix == "q" {
            &["x", "y", "z", "w"]
        } else {
            &["x", "y", "z"]
        };
        let of = |k: &&str| full_name(&first.sensor, &format!("{prefix}_{k}"));
        let name = match prefix {
            "omega" => "gyro",
            "q" => "attitude",
            "r" => "position",
            "v" => "velocity",
            _ => first.sensor.as_str(),
        };
        let Some(owner) = owner(name, axes.iter().map(of).collect()) else {
            continue;
        };
        let com = model.bodies[0].nominal.p_BoBcm_B;
        rows.extend(match prefix {
            "omega" => gyro(&owner, table),
            "q" => attitude(&owner),
            "r" | "v" => {
                let both = ["r_x", "v_x"].iter().all(|k| table.channel(k).is_some());
                let mut rows = place(&owner, table, com);
                let told = |row: &Row| both && row.kind != "unsigned";
                rows.iter_mut().for_each(|row| row.told &= told(row));
                rows
            }
            "direction" => vector(&owner, "body axes = sensor|axes"),
            _ => continue,
        });
    }
    for (kind, unit, factor) in [
        ("milliseconds", "ms", 1.0e3),
        ("minutes", "min", 1.0 / 60.0),
    ] {
        rows.push(Row::new(
            kind,
            "time",
            &[unit],
            Box::new(move |table| {
                for channel in &mut table.channels {
                    channel.time_s = channel.time_s.iter().map(|t| factor * t).collect();
                }
            }),
        ));
    }
    rows
}
