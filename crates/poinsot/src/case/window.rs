//! The part of a case that a design fills.

/// Begin and end of the part that a design fills, s; the record's own where none is given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// Begin.
    pub from: Option<f64>,
    /// End.
    pub until: Option<f64>,
}

/// What a design fills in a case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Open {
    /// Its part of the record.
    pub window: Window,
    /// Joints moved by the design.
    pub joints: Vec<usize>,
    /// Wheels moved by the design; they need no motion in the case.
    pub wheels: Vec<usize>,
}

/// Where a motion or a firing of the case lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// Flown first.
    Before,
    /// In the designed part, which replaces it.
    Within,
    /// Flown next.
    After,
    /// On both sides of an end of the designed part.
    Across,
}

/// Tables of a case that a design replaces, by their place in the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Replaced {
    /// Of `joint_motion`.
    pub joint_motion: Vec<usize>,
    /// Of `wheel_motion`.
    pub wheel_motion: Vec<usize>,
    /// Of `firing`.
    pub firing: Vec<usize>,
}

impl Replaced {
    /// Whether the case gives no manoeuvre of its own.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl Window {
    pub(super) fn part(&self, begin: f64, end: f64) -> Part {
        let (from, until) = (self.begin(), self.until.unwrap_or(f64::INFINITY));
        match (self.from, self.until) {
            (Some(from), _) if end <= from => Part::Before,
            (_, Some(until)) if begin >= until => Part::After,
            (None, _) if end <= until => Part::Within,
            _ if begin >= from && end <= until => Part::Within,
            _ => Part::Across,
        }
    }

    /// Begin, s.
    pub fn begin(&self) -> f64 {
        self.from.unwrap_or(0.0)
    }

    /// Time after the designed part of a case of this duration, s.
    pub fn rest(&self, duration_s: f64) -> f64 {
        self.until.map_or(0.0, |until| duration_s - until)
    }

    /// Whether the whole lies between a motion that ends and one that begins at these times.
    pub(super) fn is_between(&self, end: f64, begin: f64) -> bool {
        let first = self.from.is_some_and(|from| end <= from);
        first && self.until.is_some_and(|until| begin >= until)
    }

    /// Whether a firing is flown before or after the designed part.
    pub fn keeps(&self, on: f64, off: f64) -> bool {
        matches!(self.part(on, off), Part::Before | Part::After)
    }
}
