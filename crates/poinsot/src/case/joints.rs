//! `[[joint_motion]]` as motion of a joint.

use super::fault::did_you_mean;
use super::planner::{Nodes, Planner};
use poinsot_dynamics::{Fourier, JointMotion, Tree};
use poinsot_formats::case::{JointMotionFile, Placed};
use poinsot_model::JointKind;

impl Planner<'_> {
    /// The joint coordinate of a table.
    pub(super) fn joint(
        &mut self,
        tree: &Tree,
        given: &Placed<String>,
        key: &str,
    ) -> Option<usize> {
        let (name, key) = (given.get_ref(), format!("{key}.joint"));
        let Some(j) = self.model.joint(name) else {
            let names = self.model.joints.iter().map(|j| j.name.as_str());
            self.unknown("joint", &key, given, did_you_mean(name, names));
            return None;
        };
        let coordinate = tree.coordinates.iter().position(|k| *k == j);
        if coordinate.is_none() {
            let problem = "a fixed joint does not move";
            self.refuse("E0507", &key, given.span(), problem, "leave it out");
        }
        coordinate
    }

    pub(super) fn joint_motion(
        &mut self,
        table: &JointMotionFile,
        kind: JointKind,
        key: &str,
    ) -> Option<JointMotion> {
        let slides = kind == JointKind::Prismatic;
        let wrong = if slides {
            [&table.position_rad, &table.sine_rad, &table.cosine_rad]
        } else {
            [&table.position_m, &table.sine_m, &table.cosine_m]
        };
        let offset = if slides {
            &table.offset_rad
        } else {
            &table.offset_m
        };
        let spans = wrong.into_iter().flatten().map(Placed::span);
        if let Some(span) = spans.chain(offset.iter().map(Placed::span)).next() {
            let (problem, remedy) = if slides {
                (
                    "a prismatic joint moves in metres",
                    "use the keys that end in _m",
                )
            } else {
                (
                    "a revolute joint moves in radians",
                    "use the keys that end in _rad",
                )
            };
            self.refuse("E0507", key, span, problem, remedy);
            return None;
        }
        let word = table.interpolation.get_ref().as_str();
        match word {
            "quintic_rest" | "cubic_clamped" => {
                let position = if slides {
                    &table.position_m
                } else {
                    &table.position_rad
                };
                let nodes = self.nodes(table, position.as_ref(), key)?;
                let motion = match word {
                    "quintic_rest" => JointMotion::quintic_rest,
                    _ => JointMotion::cubic_clamped,
                };
                let motion = motion(nodes.0.get_ref(), nodes.1.get_ref());
                self.checked(motion, nodes, key)
            }
            "fourier" => self.fourier(table, slides, key),
            _ => {
                let words = ["quintic_rest", "cubic_clamped", "fourier"];
                let remedy = did_you_mean(word, words.into_iter());
                let key = format!("{key}.interpolation");
                let span = table.interpolation.span();
                self.refuse("E0507", &key, span, "no such interpolation", remedy);
                None
            }
        }
    }

    fn nodes<'f>(
        &mut self,
        table: &'f JointMotionFile,
        position: Option<&'f Placed<Vec<f64>>>,
        key: &str,
    ) -> Option<Nodes<'f>> {
        let harmonics = [
            &table.sine_rad,
            &table.sine_m,
            &table.cosine_rad,
            &table.cosine_m,
        ];
        if let Some(x) = harmonics.into_iter().flatten().next() {
            let problem = "harmonics belong to interpolation = \"fourier\"";
            self.refuse("E0507", key, x.span(), problem, "leave them out");
        }
        match (&table.time_s, position) {
            (Some(time), Some(position)) => Some((time, position)),
            _ => {
                let problem = "time_s and position are needed";
                let remedy = "add time_s = [...] and position_rad = [...] (prismatic: position_m)";
                self.refuse("E0502", key, table.joint.span(), problem, remedy);
                None
            }
        }
    }

    fn fourier(&mut self, table: &JointMotionFile, slides: bool, key: &str) -> Option<JointMotion> {
        let (offset, sine, cosine) = if slides {
            (&table.offset_m, &table.sine_m, &table.cosine_m)
        } else {
            (&table.offset_rad, &table.sine_rad, &table.cosine_rad)
        };
        if let Some(time) = &table.time_s {
            let problem = "a Fourier series has no nodes";
            self.refuse(
                "E0507",
                &format!("{key}.time_s"),
                time.span(),
                problem,
                "leave it out",
            );
        }
        let Some(frequency) = &table.base_frequency_hz else {
            let problem = "a Fourier series needs base_frequency_hz";
            self.refuse("E0502", key, table.joint.span(), problem, "add it");
            return None;
        };
        let list =
            |x: &Option<Placed<Vec<f64>>>| x.as_ref().map_or(Vec::new(), |x| x.get_ref().clone());
        let fourier = Fourier {
            offset: offset.as_ref().map_or(0.0, |x| *x.get_ref()),
            base_frequency_hz: *frequency.get_ref(),
            sine: list(sine),
            cosine: list(cosine),
        };
        let coefficients = || fourier.sine.iter().chain(&fourier.cosine);
        if !fourier.offset.is_finite() || !coefficients().all(|x| x.is_finite()) {
            let problem = "a coefficient is not finite";
            let remedy = "write finite numbers";
            self.refuse("E0505", key, table.joint.span(), problem, remedy);
            return None;
        }
        let base = fourier.base_frequency_hz;
        if !base.is_finite() || base <= 0.0 {
            let key = format!("{key}.base_frequency_hz");
            self.refuse(
                "E0505",
                &key,
                frequency.span(),
                "must be a positive number",
                "give one",
            );
            return None;
        }
        Some(JointMotion::Fourier(fourier))
    }
}
