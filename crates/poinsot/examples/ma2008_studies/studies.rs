//! Figures 8, 10, 12, 13, 14; comparison at equal noise; how the bounds of Sec. IV hold.

use crate::figure::{Panel, Series, svg};
use crate::monte::*;
use crate::setup::{Experiment, Run, readings, unsymmetric};
use poinsot_papers::ma2008::bounds::{angular_error, bound, linear_error, sizes};
use poinsot_papers::ma2008::{Reading, angular_rows, differences, two_step};
use poinsot_spatial::Vector3;
use std::fmt::Write;
use std::path::Path;

const SEEDS: u64 = 200;
const QUANTITIES: [&str; 3] = ["mass error, %", "mass centre error, m", "inertia error, %"];
const SCALE: [f64; 3] = [100.0, 1.0, 100.0];

fn save(out: &Path, name: &str, text: &str) {
    let path = out.join(name);
    match std::fs::write(&path, text) {
        Ok(()) => println!("written: {}", path.display()),
        Err(e) => eprintln!("{}: {e}", path.display()),
    }
}

/// Fig. 8: errors against the mass ratio, noise-free and at 1 %.
pub fn mass_ratio(out: &Path) {
    let ratios = [
        0.005, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5,
    ];
    let mut csv = String::from(
        "mass_ratio,noise,option,mass_error,com_error_m,inertia_error,mass_p05,mass_p95,com_p05_m,com_p95_m,inertia_p05,inertia_p95\n",
    );
    let mut panels: Vec<Panel> = (0..3)
        .map(|k| {
            panel(
                &format!("Fig. 8: {}", QUANTITIES[k]),
                "arm mass / base mass, %",
                QUANTITIES[k],
                true,
                true,
            )
        })
        .collect();
    for known in [true, false] {
        for share in [0.0, 0.01] {
            let mut lines: [Vec<(f64, f64)>; 3] = Default::default();
            let mut bands: [Vec<(f64, f64)>; 3] = Default::default();
            for ratio in ratios {
                let e =
                    Experiment::new(1, [0.0, 0.0, 5.0]).with_arm_factor(ratio * 1000.0 / 93.184);
                let run = e.run();
                let sigma = Sigma::of(&run, share, Scaling::Component);
                let found = trials(&e, &run, sigma, known, if share > 0.0 { SEEDS } else { 1 });
                let q = |k, q| quantile(&found, k, q);
                let _ = writeln!(
                    csv,
                    "{ratio},{share},{},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e},{:e}",
                    option(known),
                    q(0, 0.5),
                    q(1, 0.5),
                    q(2, 0.5),
                    q(0, 0.05),
                    q(0, 0.95),
                    q(1, 0.05),
                    q(1, 0.95),
                    q(2, 0.05),
                    q(2, 0.95)
                );
                for k in 0..3 {
                    lines[k].push((100.0 * ratio, SCALE[k] * q(k, 0.5)));
                    bands[k].push((SCALE[k] * q(k, 0.05), SCALE[k] * q(k, 0.95)));
                }
            }
            for ((panel, points), band) in panels.iter_mut().zip(lines).zip(bands) {
                panel.series.push(Series {
                    name: format!("option {}, noise {} %", option(known), 100.0 * share),
                    points,
                    band: if share > 0.0 { band } else { Vec::new() },
                });
            }
        }
    }
    save(out, "fig08_mass_ratio.csv", &csv);
    save(out, "fig08_mass_ratio.svg", &svg(&panels, 3));
}

fn option(known: bool) -> u8 {
    if known { 1 } else { 2 }
}

fn panel(title: &str, x: &str, y: &str, log_x: bool, log_y: bool) -> Panel {
    Panel {
        title: title.to_owned(),
        x_label: x.to_owned(),
        y_label: y.to_owned(),
        log_x,
        log_y,
        series: Vec::new(),
        marks: Vec::new(),
    }
}

/// Fig. 10 and 12: the six velocities with the marked configurations.
pub fn histories(out: &Path) {
    let figures = [
        (
            "fig10_trajectory1",
            1,
            [0.0, 0.0, 5.0],
            vec![(5.0, "A"), (45.0, "B"), (75.0, "C"), (125.0, "D")],
        ),
        (
            "fig12_trajectory2",
            2,
            [0.0, 1.0, 0.0],
            vec![(5.0, "A"), (45.0, "B")],
        ),
    ];
    for (name, trajectory, spin, marks) in figures {
        let mut e = Experiment::new(trajectory, spin).moving(0);
        let end = e.knots[e.knots.len() - 1].0;
        e.times = (0..=2 * end as usize).map(|k| 0.5 * k as f64).collect();
        let run = e.run();
        let mut csv = String::from(
            "time_s,v_x_m_s,v_y_m_s,v_z_m_s,omega_x_rad_s,omega_y_rad_s,omega_z_rad_s\n",
        );
        for (t, r) in e.times.iter().zip(&run.raws) {
            let (v, w) = (r.v_NBo_N, r.w_NB_B);
            let _ = writeln!(
                csv,
                "{t},{:e},{:e},{:e},{:e},{:e},{:e}",
                v.x, v.y, v.z, w.x, w.y, w.z
            );
        }
        let mut panels = Vec::new();
        for k in 0..6 {
            let (label, axis) = if k < 3 {
                ("v", "m/s, in N")
            } else {
                ("omega", "rad/s, in B")
            };
            let mut p = panel(
                &format!("{label}_{}", ["x", "y", "z"][k % 3]),
                "time, s",
                axis,
                false,
                false,
            );
            let at = |i: usize| {
                if k < 3 {
                    run.raws[i].v_NBo_N[k]
                } else {
                    run.raws[i].w_NB_B[k - 3]
                }
            };
            p.series.push(Series {
                name: format!("trajectory {trajectory}"),
                points: e
                    .times
                    .iter()
                    .enumerate()
                    .map(|(i, t)| (*t, at(i)))
                    .collect(),
                band: Vec::new(),
            });
            p.marks = marks.iter().map(|(t, m)| (*t, (*m).to_owned())).collect();
            panels.push(p);
        }
        save(out, &format!("{name}.csv"), &csv);
        save(out, &format!("{name}.svg"), &svg(&panels, 3));
    }
}

/// The examples of Sec. III.D.
pub fn example(n: usize) -> Experiment {
    if n == 1 {
        Experiment::new(1, [0.0, 0.0, 1.0])
    } else {
        Experiment::new(2, [0.0, 1.0, 5.0])
    }
}

/// Fig. 13 and 14: errors against noise.
pub fn noise_study(out: &Path) {
    for (name, n) in [("fig13_example1", 1), ("fig14_example2", 2)] {
        let e = example(n);
        let run = e.run();
        let mut csv = String::from("noise,scaling,option,quantity,p05,median,p95\n");
        let mut panels: Vec<Panel> = (0..3)
            .map(|k| {
                panel(
                    &format!("Fig. {}: {}", 12 + n, QUANTITIES[k]),
                    "noise, % of the maximum",
                    QUANTITIES[k],
                    false,
                    true,
                )
            })
            .collect();
        for known in [true, false] {
            for scaling in [Scaling::Component, Scaling::Largest] {
                let mut lines: [Vec<(f64, f64)>; 3] = Default::default();
                let mut bands: [Vec<(f64, f64)>; 3] = Default::default();
                for step in 1..=10 {
                    let share = 0.005 * f64::from(step);
                    let found = trials(&e, &run, Sigma::of(&run, share, scaling), known, SEEDS);
                    for (k, what) in ["mass", "com_m", "inertia", "worst_moment"]
                        .iter()
                        .enumerate()
                    {
                        let q = |q| quantile(&found, k, q);
                        let _ = writeln!(
                            csv,
                            "{share},{scaling:?},{},{what},{:e},{:e},{:e}",
                            option(known),
                            q(0.05),
                            q(0.5),
                            q(0.95)
                        );
                        if k < 3 {
                            lines[k].push((100.0 * share, SCALE[k] * q(0.5)));
                            bands[k].push((SCALE[k] * q(0.05), SCALE[k] * q(0.95)));
                        }
                    }
                }
                for ((panel, points), band) in panels.iter_mut().zip(lines).zip(bands) {
                    panel.series.push(Series {
                        name: format!(
                            "option {}, {} maximum",
                            option(known),
                            if scaling == Scaling::Component {
                                "own"
                            } else {
                                "largest"
                            }
                        ),
                        points,
                        band: if known { band } else { Vec::new() },
                    });
                }
            }
        }
        save(out, &format!("{name}.csv"), &csv);
        save(out, &format!("{name}.svg"), &svg(&panels, 3));
        for scaling in [Scaling::Component, Scaling::Largest] {
            for known in [true, false] {
                let found = trials(&e, &run, Sigma::of(&run, 0.03, scaling), known, SEEDS);
                println!(
                    "example {n}, 3 % of {scaling:?} maximum, option {}: median mass {:.2} %, mass centre {:.4} m, inertia {:.1} %, worst moment {:.1} %",
                    option(known),
                    100.0 * quantile(&found, 0, 0.5),
                    quantile(&found, 1, 0.5),
                    100.0 * quantile(&found, 2, 0.5),
                    100.0 * quantile(&found, 3, 0.5)
                );
            }
        }
    }
}

fn rms(trials: &[Errors], k: usize) -> f64 {
    (trials.iter().map(|e| e[k] * e[k]).sum::<f64>() / trials.len() as f64).sqrt()
}

/// The two steps, the linear rung and the bound on the same draws; noise 1 % of the largest component of
/// the ten stopped samples of trajectory 1 at 5 deg/s.
pub fn compare(out: &Path) {
    let reference = Experiment::new(1, [0.0, 0.0, 5.0]).run();
    let sigma = Sigma::of(&reference, 0.01, Scaling::Largest);
    println!(
        "noise: {:.2e} m/s, {:.2e} rad/s, the same in every row; rms errors of mass %, mass centre mm, inertia %",
        sigma.v.x, sigma.w.x
    );
    let mut csv = String::from(
        "motion,samples,spin_z_deg_s,method,mass_rms,com_rms_m,inertia_rms,trials,complete\n",
    );
    for (motion, spin) in [
        ("stopped", 5.0),
        ("moving", 5.0),
        ("stopped", 0.0),
        ("moving", 0.0),
    ] {
        for samples in [10, 200] {
            let mut e = Experiment::new(1, [0.0, 0.0, spin]).with_base(unsymmetric());
            e.velocity = [0.02, -0.01, 0.005];
            let e = if motion == "stopped" {
                e.stopped(samples)
            } else {
                e.moving(samples)
            };
            let run = e.run();
            let seeds = SEEDS;
            let mut rows: Vec<(&str, [f64; 3], usize)> = Vec::new();
            for known in [true, false] {
                let name = if known {
                    "ma2008 option 1"
                } else {
                    "ma2008 option 2"
                };
                let found = trials(&e, &run, sigma, known, seeds);
                rows.push((name, [0, 1, 2].map(|k| rms(&found, k)), found.len()));
            }
            // Maximum likelihood integrates between samples: it needs them dense and the arm in motion.
            let dense = motion == "moving" && samples == 200;
            for (name, known, likelihood, asked) in [
                ("linear, momentum known", true, false, true),
                ("linear, momentum unknown", false, false, true),
                ("likelihood, known", true, true, dense),
                ("likelihood, unknown", false, true, dense),
            ] {
                if !asked {
                    continue;
                }
                let of = if samples == 10 { seeds } else { 30 };
                let found: Vec<Errors> = (0..of)
                    .filter_map(|seed| {
                        let moved = draw(&run.raws, sigma, seed);
                        linear_answer(&e, &run, &moved, sigma, known, 1.0, likelihood)
                    })
                    .filter_map(|answer| properties(&answer))
                    .map(|p| errors(Some(p), &e.truth()))
                    .collect();
                rows.push((name, [0, 1, 2].map(|k| rms(&found, k)), found.len()));
            }
            rows.push((
                "bound, momentum known",
                cramer_rao(&e, &run, sigma, true),
                0,
            ));
            rows.push((
                "bound, momentum unknown",
                cramer_rao(&e, &run, sigma, false),
                0,
            ));
            println!("{motion}, {samples} samples, spin {spin} deg/s");
            for (name, r, complete) in rows {
                let shown = |x: f64, scale: f64| {
                    if (0.0..1.0).contains(&x) {
                        format!("{:10.3}", scale * x)
                    } else {
                        "      open".to_owned()
                    }
                };
                println!(
                    "  {name:26} {} % {} mm {} %{}",
                    shown(r[0], 100.0),
                    shown(r[1], 1000.0),
                    shown(r[2], 100.0),
                    if complete == 0 {
                        String::new()
                    } else {
                        format!("   ({complete} complete)")
                    }
                );
                let _ = writeln!(
                    csv,
                    "{motion},{samples},{spin},{name},{:e},{:e},{:e},{seeds},{complete}",
                    r[0], r[1], r[2]
                );
            }
        }
    }
    save(out, "comparison.csv", &csv);
}

/// Sec. IV: how often (35) holds over 10^4 trials and how loose it is.
pub fn bounds(out: &Path) {
    let mut csv = String::from(
        "example,noise,option,step,holds,holds_with_step1_error,loose_median,loose_p05,loose_p95,rms_error,bound_rms,cramer_rao_norm\n",
    );
    println!(
        "bound (35) with the error matrices of each trial, 10^4 trials; looseness = bound / error"
    );
    for n in [1, 2] {
        for share in [0.001, 0.01, 0.03] {
            for known in [true, false] {
                let e = example(n).with_base(unsymmetric());
                let run = e.run();
                let sigma = Sigma::of(&run, share, Scaling::Component);
                let exact = readings(&e.model, &run.raws);
                let option1 = known.then_some(run.known);
                let truth = two_step(std::slice::from_ref(&exact), option1);
                let Some(truth2) = truth.angular.clone() else {
                    continue;
                };
                let (m, c) = (truth.mass(), truth.rho_S());
                let trials = 10_000_u32;
                let mut held = [0_u32; 3];
                let mut loose: [Vec<f64>; 2] = Default::default();
                let (mut square, mut bound_square) = ([0.0; 2], [0.0; 2]);
                for seed in 0..u64::from(trials) {
                    let noisy = readings(&e.model, &draw(&run.raws, sigma, seed));
                    let found = two_step(std::slice::from_ref(&noisy), option1);
                    let Some(found2) = &found.angular else {
                        continue;
                    };
                    // (39), (41), (43), (45) of this trial, differenced as the option asks.
                    let pairs: Vec<(Reading, Vector3, Vector3)> = exact
                        .iter()
                        .zip(&noisy)
                        .map(|(a, b)| (*a, b.v_NBo_B - a.v_NBo_B, b.w_NB_B - a.w_NB_B))
                        .collect();
                    let d1 = less_first(
                        pairs
                            .iter()
                            .map(|(s, dv, dw)| linear_error(s, dv, dw))
                            .collect(),
                        known,
                    );
                    let d2 = less_first(
                        pairs
                            .iter()
                            .map(|(s, _, dw)| angular_error(s, m, &c, dw))
                            .collect(),
                        known,
                    );
                    let (a1, b1) = sizes::<4, 5>(&d1);
                    let (a2, b2) = sizes::<6, 7>(&d2);
                    // Beyond the paper: the right-hand side of step 2 moves with the answer of step 1, too.
                    let shifted = |m, c: Vector3| {
                        differences(
                            std::slice::from_ref(&exact),
                            move |s: &Reading| angular_rows(s, m, &c),
                            None,
                        )
                    };
                    let inherited: f64 = shifted(found.mass(), found.rho_S())
                        .iter()
                        .zip(shifted(m, c))
                        .map(|(a, b)| (a - b).column(6).norm_squared())
                        .sum::<f64>()
                        .sqrt();
                    let e1 = (found.linear.x - truth.linear.x).norm();
                    let e2 = (found2.x - truth2.x).norm();
                    let (p1, p2) = (
                        bound(&truth.linear, a1, b1).absolute,
                        bound(&truth2, a2, b2).absolute,
                    );
                    let p3 = bound(&truth2, a2, b2 + inherited).absolute;
                    for (h, ok) in held.iter_mut().zip([e1 <= p1, e2 <= p2, e2 <= p3]) {
                        *h += u32::from(ok);
                    }
                    loose[0].push(p1 / e1);
                    loose[1].push(p2 / e2);
                    for (s, e) in square.iter_mut().zip([e1, e2]) {
                        *s += e * e / f64::from(trials);
                    }
                    for (s, p) in bound_square.iter_mut().zip([p1, p2]) {
                        *s += p * p / f64::from(trials);
                    }
                }
                let cr = cramer_rao(&e, &run, sigma, known);
                for step in 0..2 {
                    loose[step].sort_by(f64::total_cmp);
                    let q = |q: f64| loose[step][(q * (loose[step].len() - 1) as f64) as usize];
                    let share_held = f64::from(held[step]) / f64::from(trials);
                    let with = f64::from(held[2 * step]) / f64::from(trials);
                    let r = truth.linear.x[0];
                    let cr_norm = if step == 0 {
                        (r * cr[0]).hypot(cr[1])
                    } else {
                        cr[2] * e.truth().I_BBcm_B.norm()
                    };
                    println!(
                        "example {n}, {:4.1} %, option {}, step {}: holds {:6.2} %{}, bound/error median {:5.1} (5 to 95 %: {:.1} to {:.1}), rms error {:.3e}, rms bound {:.3e}, Cramer-Rao {:.3e}",
                        100.0 * share,
                        option(known),
                        step + 1,
                        100.0 * share_held,
                        if step == 1 {
                            format!(" ({:.2} % with the error of step 1)", 100.0 * with)
                        } else {
                            String::new()
                        },
                        q(0.5),
                        q(0.05),
                        q(0.95),
                        square[step].sqrt(),
                        bound_square[step].sqrt(),
                        cr_norm
                    );
                    let _ = writeln!(
                        csv,
                        "{n},{share},{},{},{share_held},{with},{:e},{:e},{:e},{:e},{:e},{:e}",
                        option(known),
                        step + 1,
                        q(0.5),
                        q(0.05),
                        q(0.95),
                        square[step].sqrt(),
                        bound_square[step].sqrt(),
                        cr_norm
                    );
                }
            }
        }
    }
    save(out, "bounds.csv", &csv);
}

fn less_first<const W: usize>(
    mut rows: Vec<nalgebra::SMatrix<f64, 3, W>>,
    known: bool,
) -> Vec<nalgebra::SMatrix<f64, 3, W>> {
    if known || rows.is_empty() {
        return rows;
    }
    let first = rows.remove(0);
    rows.iter().map(|r| r - first).collect()
}

/// What the exact data give: both trajectories, all options, printed option 2 beside them.
pub fn exact() {
    use poinsot_papers::ma2008::printed::{PrintedAxes, two_step_printed};
    for (name, unsym) in [("Table 1 base", false), ("unsymmetric base", true)] {
        for (trajectory, spin) in [
            (1, [0.0, 0.0, 5.0]),
            (1, [0.0, 0.0, 1.0]),
            (2, [0.0, 1.0, 5.0]),
        ] {
            for orbit in [0.0, 7500.0] {
                let mut e = Experiment::new(trajectory, spin);
                if unsym {
                    e = e.with_base(unsymmetric());
                }
                e.velocity = [0.02 + orbit, -0.01, 0.005];
                let run: Run = e.run();
                let samples = readings(&e.model, &run.raws);
                let worst = |known| {
                    let e = errors(ma2008(&samples, known), &e.truth());
                    e[..3].iter().copied().fold(0.0, f64::max)
                };
                let printed: Vec<String> = [PrintedAxes::Body, PrintedAxes::Inertial]
                    .iter()
                    .map(|a| {
                        two_step_printed(&samples, *a)
                            .map_or("-".to_owned(), |p| format!("{:.2}", p.mass()))
                    })
                    .collect();
                println!(
                    "{name}, trajectory {trajectory}, spin {spin:?} deg/s, orbital velocity {orbit} m/s: worst error option 1 {:.1e}, option 2 {:.1e}; option 2 as printed gives {} kg (read in body axes, in N)",
                    worst(Some(run.known)),
                    worst(None),
                    printed.join(", ")
                );
            }
        }
    }
}
