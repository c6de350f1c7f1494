//! What a case flies before and after the part that a design fills.

use super::designed::{Design, Form, Moved};
use super::planner::{Planner, nodes_of_joint, nodes_of_wheel};
use super::thrusters::Fired;
use super::window::{Open, Part, Replaced, Window};
use poinsot_dynamics::PiecewisePolynomial;
use poinsot_formats::case::{CaseFile, DesignFile, FiringFile, Objective};

impl Design {
    /// What it fills in its case.
    pub fn open(&self) -> Open {
        let indices = |moved: &[Moved]| moved.iter().map(|m| m.index).collect();
        Open {
            window: self.window,
            joints: indices(&self.joints),
            wheels: indices(&self.wheels),
        }
    }
}

impl Planner<'_> {
    pub(super) fn window(&mut self, file: &DesignFile, duration_s: f64) -> Window {
        let window = Window {
            from: file.from_s,
            until: file.until_s,
        };
        let until = window.until.unwrap_or(duration_s);
        let within = |t: f64| (0.0..=duration_s).contains(&t);
        let holds = within(window.begin()) && within(until) && window.begin() < until;
        let given = [("from_s", file.from_s), ("until_s", file.until_s)];
        let placed = given.into_iter().find(|(_, x)| x.is_some());
        if let Some((key, _)) = placed.filter(|_| !holds) {
            let problem =
                "the designed part must lie within the duration, and begin before it ends";
            let key = format!("design.{key}");
            let remedy = "correct from_s, until_s or duration_s";
            self.refuse("E0505", &key, problem, remedy);
        }
        if file.until_s.is_some() && file.objective == Objective::ShortestTime {
            let problem = "the shortest time moves what is flown next";
            let remedy = "leave until_s out, or design for a fixed time";
            self.refuse("E0507", "design.until_s", problem, remedy);
        }
        window
    }

    /// Sets what the case flies before and after the designed part, and lists the tables that the design replaces.
    pub(super) fn surroundings(
        &mut self,
        file: &CaseFile,
        window: Window,
        (joints, wheels): (&mut [Moved], &mut [Moved]),
    ) -> Replaced {
        let mut replaced = Replaced::default();
        for (i, table) in file.joint_motion.iter().enumerate() {
            let mut moving = self.model.moving_joints();
            let own = moving.position(|joint| joint.name == table.joint);
            let found = joints.iter_mut().find(|m| Some(m.index) == own);
            let key = format!("joint_motion[{i}]");
            if let Some(moved) = found
                && let Some(motion) = self.joint_motion(table, moved.index, &key)
                && self.surround(moved, window, nodes_of_joint(motion), &key)
            {
                replaced.joint_motion.push(i);
            }
        }
        for (i, table) in file.wheel_motion.iter().enumerate() {
            let own = self.model.wheel(&table.wheel);
            let found = wheels.iter_mut().find(|m| Some(m.index) == own);
            let key = format!("wheel_motion[{i}]");
            if let Some(moved) = found
                && let Some(motion) = self.wheel_motion(table, &key)
                && self.surround(moved, window, nodes_of_wheel(motion), &key)
            {
                replaced.wheel_motion.push(i);
            }
        }
        replaced
    }

    /// Takes one motion of the case into account; true where the design replaces it. One that is no profile has no end.
    fn surround(
        &mut self,
        moved: &mut Moved,
        window: Window,
        profile: Option<PiecewisePolynomial>,
        key: &str,
    ) -> bool {
        let nodes = profile.as_ref().map_or(&[][..], |p| p.nodes());
        let (begin, end) = match nodes {
            [first, .., last] => (*first, *last),
            [one] => (*one, *one),
            [] => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let (side, profile) = match (window.part(begin, end), profile) {
            (Part::Within, _) => return true,
            (Part::Before, Some(p)) => (&mut moved.before, p),
            (Part::After, Some(p)) => (&mut moved.after, p),
            _ => {
                let problem = "this motion goes on across from_s or until_s of the design";
                let remedy = "let it end at from_s, or begin at until_s";
                self.refuse("E0507", key, problem, remedy);
                return false;
            }
        };
        side.push(profile);
        side.sort_by(|a, b| a.nodes()[0].total_cmp(&b.nodes()[0]));
        false
    }

    /// Starts a motion where the one before it ends, and ends it where the one after it begins.
    pub(super) fn take_up(&mut self, moved: &mut Moved, window: Window) {
        let series = matches!(moved.form, Form::Fourier { .. });
        if series && window != Window::default() {
            let problem = "a Fourier series fills the whole record";
            let remedy = "use form = \"spline\" or \"slews\" with from_s and until_s";
            self.refuse("E0507", "design.joint", problem, remedy);
            return;
        }
        if let Some(first) = moved.before.last() {
            let returns = moved.end.is_some();
            moved.start = first.ends().1;
            moved.end = returns.then_some(moved.start);
        }
        if let Some(next) = moved.after.first() {
            moved.end = Some(next.ends().0);
        }
        if matches!(moved.form, Form::Slews { slews: 1 }) && moved.end.is_some() {
            let problem = "one slew between given ends has nothing free";
            self.refuse("E0507", "design.joint", problem, "give slews = 2 or more");
        }
    }

    /// Lists the firings of the case that a design replaces, and gives each thruster the times between the others.
    pub(super) fn firings_around(
        &mut self,
        tables: &[FiringFile],
        window: Window,
        thrusters: &mut [Fired],
    ) -> Vec<usize> {
        let mut replaced = Vec::new();
        for (i, table) in tables.iter().enumerate() {
            let own = self.model.thruster(&table.thruster);
            let Some(fired) = thrusters.iter_mut().find(|f| Some(f.index) == own) else {
                continue;
            };
            let (on, off) = (table.on_s, table.off_s);
            match window.part(on, off) {
                Part::Before => fired.last_off = fired.last_off.max(off),
                Part::After => fired.next_on = fired.next_on.min(on),
                Part::Within => replaced.push(i),
                Part::Across => {
                    let problem = "this firing goes on across from_s or until_s of the design";
                    let remedy = "let it end at from_s, or begin at until_s";
                    let key = format!("firing[{i}].on_s");
                    self.refuse("E0507", &key, problem, remedy);
                }
            }
        }
        replaced
    }
}
