//! Firings with free switch-on time and duration.
//!
//! Both times are linear in the free numbers. Order, shortest duration, pause and impulse of the firings of one
//! thruster are therefore linear limits. The order between thrusters is free.

use crate::mover::Target;
use poinsot::case::{Design, Fired, ImpulseLimit, Limits, ThrusterLimit, Window};
use poinsot_dynamics::Firing;
use poinsot_formats::LimitUseFile;
use poinsot_solve::Side;

/// Duration of firings before the search, as a fraction between the shortest and longest allowed: short firings keep
/// rates low.
const REST: f64 = 0.25;
/// Free numbers of one firing: start and duration.
const EACH: usize = 2;

/// One thruster with the free numbers of its firings.
#[derive(Debug, Clone)]
pub struct Valve {
    fired: Fired,
    limit: ThrusterLimit,
    /// Times between which it may fire, s.
    free: (f64, f64),
    /// Index of its first free number.
    first: usize,
    /// Start of every firing at zero free numbers, s.
    on: Vec<f64>,
    /// Duration of every firing at zero free numbers, s.
    length: f64,
    /// Scale of the two free numbers of a firing, s.
    units: [f64; EACH],
}

/// All thrusters of a design.
#[derive(Debug, Clone, Default)]
pub struct Valves {
    list: Vec<Valve>,
    window: Window,
    impulses: Vec<ImpulseLimit>,
}

impl Valves {
    /// Equally spaced firings with a fraction of their longest duration; free numbers start at `first`.
    pub fn new(
        (design, limits): (&Design, &Limits),
        mut first: usize,
        (from, until): (f64, f64),
    ) -> Result<Self, (Target, String)> {
        let mut list = Vec::new();
        for fired in &design.thrusters {
            let limit = limits.thrusters[fired.index];
            let free = (
                from.max(fired.last_off + limit.minimum_off),
                until.min(fired.next_on - limit.minimum_off),
            );
            let slot = (free.1 - free.0) / fired.firings as f64;
            let room = slot - limit.minimum_off;
            let longest = room.min(longest_affordable(fired.index, design, limits));
            let length = limit.minimum_on + REST * (longest - limit.minimum_on);
            if longest.is_nan() || longest <= limit.minimum_on {
                let why = format!(
                    "{} firings of at least {} s do not fit into its time and impulse; give fewer firings, more time or a larger budget",
                    fired.firings, limit.minimum_on
                );
                return Err((Target::Thruster(fired.index), why));
            }
            let begin = |k: usize| free.0 + k as f64 * slot + 0.5 * (slot - length);
            list.push(Valve {
                fired: *fired,
                limit,
                free,
                first,
                on: (0..fired.firings).map(begin).collect(),
                length,
                units: [slot, longest - limit.minimum_on],
            });
            first += EACH * fired.firings;
        }
        Ok(Self {
            list,
            window: design.window,
            impulses: limits.impulses.clone(),
        })
    }

    /// Number of free numbers.
    pub fn len(&self) -> usize {
        self.list.iter().map(|v| EACH * v.fired.firings).sum()
    }

    /// Whether the designed firings take the place of this one.
    pub fn replaces(&self, firing: &Firing) -> bool {
        let own = self.list.iter().any(|v| v.fired.index == firing.thruster);
        own && !self.window.keeps(firing.on, firing.off)
    }

    /// The firings that the free numbers give.
    pub fn firings(&self, x: &[f64]) -> Vec<Firing> {
        self.list.iter().flat_map(|v| v.firings(x)).collect()
    }

    /// Blocks of free numbers scaled together: for each thruster the durations, then the starts.
    pub fn blocks(&self) -> Vec<Vec<usize>> {
        let of = |v: &Valve, part: usize| (0..v.fired.firings).map(|k| v.at(k, part)).collect();
        let lengths = self.list.iter().map(|v| of(v, 1));
        lengths.chain(self.list.iter().map(|v| of(v, 0))).collect()
    }

    /// The linear limits.
    pub fn sides(&self) -> Vec<Side> {
        let mut sides: Vec<Side> = self.list.iter().flat_map(Valve::sides).collect();
        for limit in &self.impulses {
            let mut a = Vec::new();
            let mut at_rest = limit.spent;
            for v in self.list.iter().filter(|v| limit.holds(v.fired.index)) {
                at_rest += v.fired.force * v.length * v.fired.firings as f64;
                let slope = v.fired.force * v.units[1] / limit.impulse;
                a.extend((0..v.fired.firings).map(|k| (v.at(k, 1), slope)));
            }
            if !a.is_empty() {
                sides.push(Side {
                    a,
                    low: f64::NEG_INFINITY,
                    high: 1.0 - at_rest / limit.impulse,
                });
            }
        }
        sides
    }

    /// Sets the free numbers to given firings, for thrusters with the declared number of firings.
    pub fn take(&self, given: &[Firing], x: &mut [f64]) {
        for v in &self.list {
            let mut own: Vec<&Firing> = given
                .iter()
                .filter(|f| f.thruster == v.fired.index && self.replaces(f))
                .collect();
            if own.len() != v.fired.firings {
                continue;
            }
            own.sort_by(|a, b| a.on.total_cmp(&b.on));
            for (k, f) in own.into_iter().enumerate() {
                x[v.at(k, 0)] = (f.on - v.on[k]) / v.units[0];
                x[v.at(k, 1)] = (f.off - f.on - v.length) / v.units[1];
            }
        }
    }

    /// Use of the limits by the firings; `name` maps a thruster to its name.
    pub fn uses(&self, x: &[f64], name: impl Fn(usize) -> String) -> Vec<LimitUseFile> {
        let mut all = Vec::new();
        for v in &self.list {
            let own = v.firings(x);
            let least =
                |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
            let shortest = least(&mut own.iter().map(|f| f.off - f.on));
            let pause = least(&mut own.windows(2).map(|pair| pair[1].on - pair[0].off));
            let name = name(v.fired.index);
            for (what, value, limit) in [
                ("firing", shortest, v.limit.minimum_on),
                ("pause", pause, v.limit.minimum_off),
            ] {
                if limit > 0.0 && value.is_finite() {
                    let (what, margin) = (format!("{what} of {name}"), value / limit - 1.0);
                    all.push(LimitUseFile::new(what, "s", value, limit, margin));
                }
            }
        }
        let firings = self.firings(x);
        for limit in &self.impulses {
            let own = firings.iter().filter(|f| limit.holds(f.thruster));
            let spent = limit.spent + own.map(|f| f.force * (f.off - f.on)).sum::<f64>();
            let names: Vec<String> = limit.thrusters.iter().map(|k| name(*k)).collect();
            let (word, unit, scale) = match limit.exhaust {
                Some(exhaust) => ("propellant", "kg", 1.0 / exhaust),
                None => ("impulse", "N s", 1.0),
            };
            all.push(LimitUseFile::new(
                format!("{word} of {}", names.join(", ")),
                unit,
                scale * spent,
                scale * limit.impulse,
                1.0 - spent / limit.impulse,
            ));
        }
        all
    }
}

impl Valve {
    /// Index of a free number of a firing: part 0 is its start, part 1 its duration.
    fn at(&self, firing: usize, part: usize) -> usize {
        self.first + EACH * firing + part
    }

    fn firings(&self, x: &[f64]) -> Vec<Firing> {
        let of = |k: usize| {
            let on = self.on[k] + self.units[0] * x[self.at(k, 0)];
            Firing {
                thruster: self.fired.index,
                on,
                off: on + self.length + self.units[1] * x[self.at(k, 1)],
                force: self.fired.force,
            }
        };
        (0..self.fired.firings).map(of).collect()
    }

    /// Limits: within the record, ordered with pauses, none too short; in units of a start.
    fn sides(&self) -> Vec<Side> {
        let last = self.fired.firings - 1;
        let [slot, grow] = self.units;
        let longer = grow / slot;
        let at_least = |a: Vec<(usize, f64)>, low: f64| Side {
            a,
            low,
            high: f64::INFINITY,
        };
        let mut sides = vec![
            at_least(
                vec![(self.at(0, 0), 1.0)],
                (self.free.0 - self.on[0]) / slot,
            ),
            Side {
                a: vec![(self.at(last, 0), 1.0), (self.at(last, 1), longer)],
                low: f64::NEG_INFINITY,
                high: (self.free.1 - self.on[last] - self.length) / slot,
            },
        ];
        for k in 0..self.fired.firings {
            let shortest = (self.limit.minimum_on - self.length) / grow;
            sides.push(at_least(vec![(self.at(k, 1), 1.0)], shortest));
        }
        for k in 0..last {
            let pause = self.on[k + 1] - self.on[k] - self.length;
            let a = vec![
                (self.at(k + 1, 0), 1.0),
                (self.at(k, 0), -1.0),
                (self.at(k, 1), -longer),
            ];
            sides.push(at_least(a, (self.limit.minimum_off - pause) / slot));
        }
        sides
    }
}

/// Duration of each firing that exhausts the smallest budget of a thruster.
fn longest_affordable(thruster: usize, design: &Design, limits: &Limits) -> f64 {
    let of = |limit: &ImpulseLimit| {
        let own = design.thrusters.iter().filter(|f| limit.holds(f.index));
        let force: f64 = own.map(|f| f.force * f.firings as f64).sum();
        (limit.impulse - limit.spent) / force
    };
    let budgets = limits.impulses.iter().filter(|l| l.holds(thruster));
    budgets.map(of).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use poinsot_solve::Polytope;
    use rand::{RngExt, SeedableRng};

    fn two_thrusters() -> Valves {
        let limit = ThrusterLimit {
            minimum_on: 0.5,
            minimum_off: 1.0,
            plume: None,
        };
        let fired = |index, firings, force| Fired {
            index,
            firings,
            force,
            last_off: f64::NEG_INFINITY,
            next_on: f64::INFINITY,
        };
        let impulse = ImpulseLimit {
            thrusters: vec![0, 1],
            impulse: 40.0,
            spent: 4.0,
            exhaust: None,
        };
        let thrusters = [fired(0, 3, 2.0), fired(1, 2, 5.0)];
        let list = thrusters.into_iter().scan(0, |first, fired| {
            let own = *first;
            *first += EACH * fired.firings;
            let slot = 60.0 / fired.firings as f64;
            Some(Valve {
                fired,
                limit,
                free: (0.0, 60.0),
                first: own,
                on: (0..fired.firings)
                    .map(|k| (k as f64 + 0.5) * slot)
                    .collect(),
                length: 0.8,
                units: [slot, 1.5],
            })
        });
        Valves {
            list: list.collect(),
            window: Window::default(),
            impulses: vec![impulse],
        }
    }

    /// Random numbers scaled to the limits: firings are ordered, long enough, separated and within budget. Each limit
    /// is reached by some.
    #[test]
    fn prop_firings_inside_the_sides_hold_every_limit() {
        let valves = two_thrusters();
        let polytope = Polytope {
            sides: valves.sides(),
        };
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let mut least = [f64::INFINITY; 4];
        for _ in 0..3000 {
            let rest = vec![0.0; valves.len()];
            let direction: Vec<f64> = rest.iter().map(|_| rng.random_range(-1.0..1.0)).collect();
            let reach = polytope.reach(&rest, &direction);
            let x: Vec<f64> = direction.iter().map(|d| reach * d).collect();
            let spent: f64 = valves
                .firings(&x)
                .iter()
                .map(|f| f.force * (f.off - f.on))
                .sum();
            least[3] = least[3].min(36.0 - spent);
            for v in &valves.list {
                let own = v.firings(&x);
                least[0] = least[0].min(own[0].on).min(60.0 - own[own.len() - 1].off);
                for f in &own {
                    least[1] = least[1].min(f.off - f.on - 0.5);
                }
                for pair in own.windows(2) {
                    least[2] = least[2].min(pair[1].on - pair[0].off - 1.0);
                }
            }
            let mut again = rest;
            valves.take(&valves.firings(&x), &mut again);
            assert!(x.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1.0e-12));
        }
        assert!(
            least.iter().all(|l| *l > -1.0e-9),
            "a limit is broken: {least:?}"
        );
        // Random firings approach every limit of a thruster; only long ones use the whole impulse.
        assert!(
            least[..3].iter().all(|l| *l < 0.5) && least[3] < 5.0,
            "no firing comes near a limit: {least:?}"
        );
    }
}
