//! A segment on a finer grid: the same samples, and inputs at more times.

use crate::segment::{InputErrors, Observations, Segment};

/// Times closer than this share of the shortest grid step that can matter are one time, s.
const SAME_S: f64 = 1.0e-7;

/// A segment with more grid times, in any order; those beyond its ends or at a grid time are left out. Wheel speeds at
/// the new times are those of the straight line.
pub(crate) fn refined(segment: &Segment, more: &[f64]) -> Segment {
    let o = &segment.observations;
    let (Some(first), Some(last)) = (o.time_s.first(), o.time_s.last()) else {
        return segment.clone();
    };
    let inside = more.iter().filter(|t| *t > first && *t < last);
    // Old times first among equals: they stay.
    let mut all: Vec<(f64, Option<usize>)> = inside.map(|t| (*t, None)).collect();
    all.extend(o.time_s.iter().enumerate().map(|(k, t)| (*t, Some(k))));
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut times: Vec<(f64, Option<usize>)> = Vec::with_capacity(all.len());
    for (t, old) in all {
        match times.last_mut().filter(|last| t - last.0 <= SAME_S) {
            Some(last) if last.1.is_none() => *last = (t, old),
            Some(_) if old.is_none() => {}
            _ => times.push((t, old)),
        }
    }
    let places = Places::new(o, &times);
    let mut points = o.points.clone();
    for reading in points.iter_mut().flat_map(|p| &mut p.readings) {
        reading.from = places.new_of[reading.from];
        reading.to = places.new_of[reading.to];
    }
    let (joint_position, joint_rate) = places.joints(o);
    let observations = Observations {
        rate: places.own(&o.rate),
        attitude: places.own(&o.attitude),
        velocity: places.own(&o.velocity),
        position: places.own(&o.position),
        orbit: places.orbit(o),
        points,
        joint_position,
        joint_rate,
        wheel_speed: places.straight(&o.wheel_speed, o.time_s.len()),
        joint_errors: o.joint_errors.iter().map(|e| places.errors(o, e)).collect(),
        wheel_errors: o.wheel_errors.iter().map(|e| places.errors(o, e)).collect(),
        time_s: times.iter().map(|t| t.0).collect(),
        ..o.clone()
    };
    Segment {
        observations,
        ..segment.clone()
    }
}

/// Where each new time lies: the old grid time before it, and the share of the interval after that.
struct Places {
    before: Vec<(usize, f64)>,
    is_old: Vec<bool>,
    new_of: Vec<usize>,
}

impl Places {
    fn new(o: &Observations, times: &[(f64, Option<usize>)]) -> Self {
        let mut places = Self {
            before: Vec::with_capacity(times.len()),
            is_old: Vec::with_capacity(times.len()),
            new_of: Vec::with_capacity(o.time_s.len()),
        };
        let mut at = 0;
        for (k, (t, old)) in times.iter().enumerate() {
            if let Some(old) = old {
                at = *old;
                places.new_of.push(k);
            }
            let h = o.time_s.get(at + 1).map_or(1.0, |next| next - o.time_s[at]);
            let share = if old.is_some() {
                0.0
            } else {
                (t - o.time_s[at]) / h
            };
            places.before.push((at, share));
            places.is_old.push(old.is_some());
        }
        places
    }

    fn own<T: Clone>(&self, all: &[Option<T>]) -> Vec<Option<T>> {
        let pairs = self.before.iter().zip(&self.is_old);
        pairs
            .map(|((k, _), old)| all.get(*k).filter(|_| *old).cloned().flatten())
            .collect()
    }

    fn straight(&self, all: &[f64], times: usize) -> Vec<f64> {
        let width = all.len() / times.max(1);
        let row = |&(k, share): &(usize, f64)| {
            (0..width).map(move |j| {
                let value = all[k * width + j];
                let next = all.get((k + 1) * width + j).copied().unwrap_or(value);
                value + share * (next - value)
            })
        };
        self.before.iter().flat_map(row).collect()
    }

    /// Positions and rates on the cubic through those of both grid times.
    fn joints(&self, o: &Observations) -> (Vec<f64>, Vec<f64>) {
        let dof = o.joint_position.len() / o.time_s.len().max(1);
        let (mut positions, mut rates) = (Vec::new(), Vec::new());
        for &(k, share) in &self.before {
            for j in 0..dof {
                let (a, b) = (k * dof + j, (k + 1) * dof + j);
                let (q, v) = (o.joint_position[a], o.joint_rate[a]);
                if share == 0.0 {
                    positions.push(q);
                    rates.push(v);
                    continue;
                }
                let h = o.time_s[k + 1] - o.time_s[k];
                let (d0, d1, dq) = (v * h, o.joint_rate[b] * h, o.joint_position[b] - q);
                let (c2, c3) = (3.0 * dq - 2.0 * d0 - d1, d0 + d1 - 2.0 * dq);
                positions.push(q + share * (d0 + share * (c2 + share * c3)));
                rates.push((d0 + share * (2.0 * c2 + share * 3.0 * c3)) / h);
            }
        }
        (positions, rates)
    }

    fn orbit(&self, o: &Observations) -> Vec<(poinsot_spatial::Vector3, poinsot_spatial::Vector3)> {
        if o.orbit.is_empty() {
            return Vec::new();
        }
        let at = |&(k, s): &(usize, f64)| {
            let (p0, v0) = o.orbit[k];
            let Some((p1, v1)) = o.orbit.get(k + 1).filter(|_| s > 0.0) else {
                return (p0, v0);
            };
            let h = o.time_s[k + 1] - o.time_s[k];
            let (d0, d1, dp) = (v0 * h, v1 * h, p1 - p0);
            let (c2, c3) = (dp * 3.0 - d0 * 2.0 - d1, d0 + d1 - dp * 2.0);
            let p = p0 + (d0 + (c2 + c3 * s) * s) * s;
            (p, (d0 + (c2 * 2.0 + c3 * (3.0 * s)) * s) / h)
        };
        self.before.iter().map(at).collect()
    }

    /// Values between samples share their errors: the noise per second stays.
    fn errors(&self, o: &Observations, errors: &InputErrors) -> InputErrors {
        if !matches!(errors, InputErrors::Kept(_) | InputErrors::Independent) {
            return errors.clone();
        }
        let time = |k: usize| {
            let (at, share) = self.before[k];
            let h = o.time_s.get(at + 1).map_or(0.0, |next| next - o.time_s[at]);
            o.time_s[at] + share * h
        };
        let mut memory: Vec<f64> = (1..self.before.len())
            .map(|k| {
                let at = self.before[k - 1].0;
                let whole = o.time_s[at + 1] - o.time_s[at];
                let (h, a) = (time(k) - time(k - 1), errors.memory(at));
                if self.is_old[k - 1] && self.is_old[k] || a >= 1.0 {
                    return a;
                }
                let apart = whole * (1.0 + a) / (1.0 - a);
                ((apart - h) / (apart + h)).max(0.0)
            })
            .collect();
        memory.push(0.0);
        InputErrors::Kept(memory)
    }
}
