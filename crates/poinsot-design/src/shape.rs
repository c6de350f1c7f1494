//! The free numbers of a manoeuvre: the motions of joints and wheels that they give, and their linear limits.
//!
//! Every form is linear in its free numbers, so every limit of a commanded position, rate or acceleration is linear
//! too. Limits hold between points as well. A cubic lies in the hull of its Bezier points, and a rest-to-rest quintic
//! has its peaks at known times. A trigonometric polynomial of degree K is at most `1 / cos(pi K / N)` times its
//! largest value at N equidistant points (Ehlich and Zeller 1964).

use crate::mover::{Command, Mover, Order, Target, middle};
use crate::valves::Valves;
use poinsot::case::{Design, Limits, Scenario};
use poinsot_dynamics::{JointDrive, JointMotion, WheelMotion};
use poinsot_formats::LimitUseFile;
use poinsot_model::Model;
use poinsot_solve::{Polytope, Side};

/// Excess of a side, in its units, that is round-off.
const ROUND_OFF: f64 = 1.0e-9;

/// Largest use of a linear limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Use {
    /// Index of the mover.
    pub mover: usize,
    /// Limited derivative.
    pub order: Order,
    /// Value nearest to its limit.
    pub value: f64,
    /// The limit.
    pub limit: f64,
}

/// All free numbers of a manoeuvre of fixed duration.
#[derive(Debug, Clone)]
pub struct Space {
    /// Begin of the designed part, s.
    pub from: f64,
    /// Its duration, s.
    pub duration: f64,
    /// Time after it, s.
    pub rest: f64,
    /// Joints, then wheels.
    pub movers: Vec<Mover>,
    /// Thrusters; their free numbers follow those of the joints and wheels.
    pub valves: Valves,
    /// Limits on the free numbers.
    pub polytope: Polytope,
    /// Free numbers away from all limits. Zero, a mover at its start, may lie on one.
    centre: Vec<f64>,
    /// Meaning of each of the first sides; those of the thrusters follow.
    of_side: Vec<SideOf>,
}

/// Meaning of a side of the polytope: commanded value = `scale` times the side plus `offset`.
#[derive(Debug, Clone, Copy)]
struct SideOf {
    mover: usize,
    order: Order,
    scale: f64,
    offset: f64,
}

impl Space {
    /// Creates the free numbers of a design of this duration, with `rest` after it. An error names a mover that is
    /// unbounded or starts outside its limits.
    pub fn new(
        design: &Design,
        limits: &Limits,
        (duration, rest): (f64, f64),
    ) -> Result<Self, (Target, String)> {
        let both = |x: f64| (-x, x);
        let joints = design.joints.iter().map(|m| {
            let l = &limits.joints[m.index];
            let bounds = [l.position, both(l.rate), both(l.acceleration)];
            (Target::Joint(m.index), m, bounds)
        });
        let wheels = design.wheels.iter().map(|m| {
            let speed = both(limits.wheels[m.index].speed);
            let free = both(f64::INFINITY);
            (Target::Wheel(m.index), m, [speed, free, free])
        });
        let (mut movers, mut first) = (Vec::new(), 0);
        for (target, moved, bounds) in joints.chain(wheels) {
            let mover = Mover::new(target, moved, bounds, first, duration)?;
            first += mover.units.len();
            movers.push(mover);
        }
        let from = design.window.begin();
        let valves = Valves::new((design, limits), first, (from, from + duration))?;
        let mut space = Self {
            from,
            duration,
            rest,
            movers,
            valves,
            polytope: Polytope::default(),
            centre: Vec::new(),
            of_side: Vec::new(),
        };
        for k in 0..space.movers.len() {
            space.add_sides(k);
        }
        space.polytope.sides.extend(space.valves.sides());
        space.find_centre();
        Ok(space)
    }

    /// Number of free numbers.
    pub fn len(&self) -> usize {
        self.movers.iter().map(|m| m.units.len()).sum::<usize>() + self.valves.len()
    }

    /// Duration of the record, s.
    pub fn record(&self) -> f64 {
        self.from + self.duration + self.rest
    }

    /// The commanded motion of every mover, from the begin of the designed part.
    pub fn commands(&self, x: &[f64]) -> Vec<Command> {
        let of = |m: &Mover| m.command(&x[m.first..m.first + m.units.len()], self.duration);
        self.movers.iter().map(of).collect()
    }

    /// The same motions of joints and wheels in free numbers of another space, whose units are those of its limits.
    pub fn converted(&self, x: &[f64], to: &Self) -> Vec<f64> {
        let mut all = x.to_vec();
        for (own, other) in self.movers.iter().zip(&to.movers) {
            let units = own.units.iter().zip(&other.units);
            for (x, (from, to)) in all[own.first..].iter_mut().zip(units) {
                *x *= from / to;
            }
        }
        all
    }

    /// Writes the motions into a scenario.
    pub fn place(&self, x: &[f64], scenario: &mut Scenario) -> Option<()> {
        let plan = &mut scenario.plan;
        for (mover, command) in self.movers.iter().zip(self.commands(x)) {
            match mover.target {
                Target::Joint(k) => {
                    *plan.joints.get_mut(k)? = mover.whole(command, self.from)?.into();
                }
                Target::Wheel(k) => {
                    let JointMotion::Nodes(speed) = mover.whole(command, self.from)? else {
                        return None;
                    };
                    *plan.wheels.get_mut(k)? = WheelMotion::Speed(speed);
                }
                Target::Thruster(_) => {}
            }
        }
        plan.firings.retain(|f| !self.valves.replaces(f));
        plan.firings.extend(self.valves.firings(x));
        Some(())
    }

    /// Use of all linear limits: the largest for each mover and order.
    pub fn uses(&self, x: &[f64]) -> Vec<Use> {
        let mut all: Vec<Use> = Vec::new();
        for (side, of) in self.polytope.sides.iter().zip(&self.of_side) {
            let (low, high) = self.movers[of.mover].bounds[of.order as usize];
            let value = side.at(x) * of.scale + of.offset;
            let limit = if high - value <= value - low {
                high
            } else {
                low
            };
            let one = Use {
                mover: of.mover,
                order: of.order,
                value,
                limit,
            };
            let gap = |u: &Use| (u.limit - u.value).abs();
            let same = |u: &&mut Use| u.mover == of.mover && u.order == of.order;
            match all.iter_mut().find(same) {
                Some(u) if gap(u) <= gap(&one) => {}
                Some(u) => *u = one,
                None => all.push(one),
            }
        }
        all
    }

    /// Free numbers whose commands approximate given motions, scaled towards rest until within the limits.
    pub fn nearest(&self, scenario: &Scenario) -> Vec<f64> {
        let mut x = vec![0.0; self.len()];
        for mover in &self.movers {
            let own = match mover.target {
                Target::Joint(k) => match scenario.plan.joints.get(k) {
                    Some(JointDrive::Motion(motion)) => Some(motion.clone()),
                    _ => None,
                },
                Target::Wheel(k) => match scenario.plan.wheels.get(k) {
                    Some(WheelMotion::Speed(p)) => Some(JointMotion::Nodes(p.clone())),
                    _ => None,
                },
                Target::Thruster(_) => None,
            };
            if let Some(fitted) =
                own.and_then(|motion| mover.fitted(&motion, self.from, self.duration))
            {
                x[mover.first..mover.first + fitted.len()].copy_from_slice(&fitted);
            }
        }
        self.valves.take(&scenario.plan.firings, &mut x);
        self.drawn_inside(x)
    }

    /// Blocks of free numbers scaled together: those of each mover, and durations and starts of the firings of each
    /// thruster.
    fn blocks(&self) -> Vec<Vec<usize>> {
        let of = |m: &Mover| (m.first..m.first + m.units.len()).collect();
        let movers = self.movers.iter().map(of);
        movers.chain(self.valves.blocks()).collect()
    }

    /// The point, or the nearest to it within the limits on the way from the centre, block by block.
    pub fn drawn_inside(&self, x: Vec<f64>) -> Vec<f64> {
        if self.polytope.holds(&x, ROUND_OFF) {
            return x;
        }
        let from_centre: Vec<f64> = x.iter().zip(&self.centre).map(|(x, c)| x - c).collect();
        self.scaled(&from_centre, |reach| reach.min(1.0))
    }

    /// Goes from the centre in a direction until each block uses `share` of its limits.
    pub fn stretched(&self, direction: &[f64], share: f64) -> Vec<f64> {
        self.scaled(direction, |reach| share * reach)
    }

    /// Scales each block by `factor(reach)`, where `reach` is the largest factor within the limits, given the earlier
    /// blocks.
    fn scaled(&self, direction: &[f64], factor: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut x = self.centre.clone();
        let mut own = vec![0.0; direction.len()];
        for block in self.blocks() {
            block.iter().for_each(|j| own[*j] = direction[*j]);
            let by = factor(self.polytope.reach(&x, &own));
            for j in block {
                x[j] += by * direction[j];
                own[j] = 0.0;
            }
        }
        x
    }

    /// Half of the way from the start towards the middle of each range that the limits allow.
    fn find_centre(&mut self) {
        self.centre = vec![0.0; self.len()];
        let towards: Vec<f64> = self.movers.iter().flat_map(Mover::towards_middle).collect();
        let mut direction = self.centre.clone();
        direction[..towards.len()].copy_from_slice(&towards);
        self.centre = self.scaled(&direction, |reach| 0.5 * reach.min(1.0));
    }

    fn add_sides(&mut self, k: usize) {
        let mover = &self.movers[k];
        let n = mover.units.len();
        let at = |x: &[f64]| mover.points(&mover.command(x, self.duration));
        let rest = at(&vec![0.0; n]);
        let columns: Vec<Vec<(Order, f64)>> = (0..n)
            .map(|j| {
                let mut unit = vec![0.0; n];
                unit[j] = 1.0;
                at(&unit)
            })
            .collect();
        let shrink = mover.shrink();
        for (i, &(order, offset)) in rest.iter().enumerate() {
            let (low, high) = mover.bounds[order as usize];
            if low.is_infinite() && high.is_infinite() {
                continue;
            }
            let middle =
                middle((low, high), mover.start) * f64::from(u8::from(order == Order::Value));
            let scale = match high.is_finite() {
                true => high - middle,
                false => middle - low,
            };
            let a: Vec<(usize, f64)> = (0..n)
                .map(|j| (mover.first + j, (columns[j][i].1 - offset) / scale))
                .filter(|(_, a)| a.abs() > 1.0e-14)
                .collect();
            if a.is_empty() {
                continue;
            }
            let end = |bound: f64| (middle + shrink * (bound - middle) - offset) / scale;
            self.polytope.sides.push(Side {
                a,
                low: end(low),
                high: end(high),
            });
            self.of_side.push(SideOf {
                mover: k,
                order,
                scale,
                offset,
            });
        }
    }
}

/// Use of the limits that hold without a simulation: of motions and of firings.
pub(crate) fn linear_uses(model: &Model, space: &Space, x: &[f64]) -> Vec<LimitUseFile> {
    let mut all = space.valves.uses(x, |k| Target::Thruster(k).name(model));
    all.extend(space.uses(x).iter().map(|u| linear_use(model, space, u)));
    all
}

fn linear_use(model: &Model, space: &Space, u: &Use) -> LimitUseFile {
    let mover = &space.movers[u.mover];
    let (low, high) = mover.bounds[u.order as usize];
    let half = match low.is_finite() && high.is_finite() {
        true => 0.5 * (high - low),
        false => u.limit.abs(),
    };
    let (word, unit) = match (mover.target, u.order, mover.slides) {
        (Target::Wheel(_), ..) => ("speed", "rad/s"),
        (_, Order::Value, false) => ("position", "rad"),
        (_, Order::Value, true) => ("position", "m"),
        (_, Order::Rate, false) => ("rate", "rad/s"),
        (_, Order::Rate, true) => ("rate", "m/s"),
        (_, Order::Acceleration, false) => ("acceleration", "rad/s2"),
        (_, Order::Acceleration, true) => ("acceleration", "m/s2"),
    };
    let what = format!("{word} of {}", mover.target.name(model));
    let margin = (u.limit - u.value).abs() / half;
    let sign = if inside(u, low, high) { 1.0 } else { -1.0 };
    LimitUseFile::new(what, unit, u.value, u.limit, margin * sign)
}

fn inside(u: &Use, low: f64, high: f64) -> bool {
    let slack = 1.0e-9 * u.limit.abs();
    (low - slack..=high + slack).contains(&u.value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot::case::{Form, Moved};
    use rand::RngExt;
    use rand::SeedableRng;

    fn mover(form: Form, start: f64, bounds: [(f64, f64); 3]) -> Space {
        let moved = Moved {
            index: 0,
            slides: false,
            form,
            start,
            end: Some(start),
            before: Vec::new(),
            after: Vec::new(),
        };
        let mover = Mover::new(Target::Joint(0), &moved, bounds, 0, 40.0).unwrap();
        let mut space = Space {
            from: 0.0,
            duration: 40.0,
            rest: 0.0,
            movers: vec![mover],
            valves: Valves::default(),
            polytope: Polytope::default(),
            centre: Vec::new(),
            of_side: Vec::new(),
        };
        space.add_sides(0);
        space.find_centre();
        space
    }

    /// Motions scaled to their limits and sampled 100 times as densely hold every limit, and the hull is not much too
    /// tight.
    #[test]
    fn prop_limits_hold_between_the_points_for_every_form() {
        let both = |x: f64| (-x, x);
        let bounds = [(-0.5, 1.1), both(0.11), both(0.03)];
        let fourier = |at_rest| Form::Fourier {
            harmonics: 3,
            base_frequency_hz: None,
            at_rest,
        };
        // The last start is on a limit.
        let forms = [
            (fourier(false), 0.2),
            (fourier(true), 0.2),
            (Form::Spline { nodes: 8 }, 0.2),
            (Form::Slews { slews: 4 }, 0.2),
            (Form::Spline { nodes: 8 }, 1.1),
        ];
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(22);
        for (form, start) in forms {
            let space = mover(form, start, bounds);
            let mut closest = 0.0_f64;
            for _ in 0..50 {
                let d: Vec<f64> = (0..space.len())
                    .map(|_| rng.random_range(-1.0..1.0))
                    .collect();
                let x = space.stretched(&d, 1.0);
                let motion = space.commands(&x)[0].joint().unwrap();
                let mut share = 0.0_f64;
                for i in 0..20_000 {
                    let t = 40.0 * (f64::from(i) + 0.5) / 20_000.0;
                    let jet = motion.at(t, t);
                    share = share
                        .max((jet.value - 0.3).abs() / 0.8)
                        .max(jet.rate.abs() / 0.11)
                        .max(jet.acceleration.abs() / 0.03);
                }
                assert!(share <= 1.0 + 1.0e-9, "{form:?} {share}");
                closest = closest.max(share);
            }
            assert!(closest > 0.995, "{form:?} {closest}");
        }
    }

    #[test]
    fn exact_a_manoeuvre_of_the_same_form_is_found_again() {
        let both = |x: f64| (-x, x);
        let form = Form::Spline { nodes: 7 };
        let space = mover(form, 0.2, [both(2.0), both(1.0), both(1.0)]);
        let x = space.stretched(&[0.4, -0.3, 0.2, 0.5, -0.1], 0.7);
        let motion = space.commands(&x)[0].joint().unwrap();
        let found = space.movers[0].fitted(&motion, 0.0, 40.0).unwrap();
        for (a, b) in x.iter().zip(found) {
            assert!((a - b).abs() < 1.0e-9);
        }
    }
}
