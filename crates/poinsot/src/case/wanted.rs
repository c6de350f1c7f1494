//! `[[want]]`: numbers or combinations of body numbers, with their wanted sigmas.

use super::Case;
use super::fault::did_you_mean;
use super::planner::Planner;
use crate::error::Error;
use crate::mass_numbers::names;
use poinsot_formats::Address;
use poinsot_formats::case::WantFile;
use poinsot_identify::WantedTerm;
use poinsot_model::Model;
use poinsot_spatial::MASS_PROPERTY_UNITS;
use std::collections::BTreeMap;

/// A number or combination with its wanted sigma.
#[derive(Debug, Clone, PartialEq)]
pub struct Want {
    /// As in the case: `target.mass_kg`, `target.inertia_kg_m2.xx`, or a weighted sum.
    pub name: String,
    /// Unit of the sigma.
    pub unit: &'static str,
    /// Its terms.
    pub terms: Vec<WantedTerm>,
    /// Wanted one-sigma uncertainty, in the unit.
    pub sigma: f64,
}

/// Groups of body numbers, by the end of their address.
const GROUPS: [&str; 3] = ["mass_kg", "com_m", "inertia_kg_m2"];

impl Case {
    /// Wanted numbers of a model; empty without `[[want]]`.
    ///
    /// # Errors
    /// All faults with this model.
    pub fn wants(&self, model: &Model) -> Result<Vec<Want>, Error> {
        let tables = self.file.want.iter().enumerate();
        self.planned(model, |planner| {
            let wants = tables.filter_map(|(i, table)| planner.want(table, &format!("want[{i}]")));
            wants.flatten().collect()
        })
    }
}

impl Planner<'_> {
    fn want(&mut self, table: &WantFile, key: &str) -> Option<Vec<Want>> {
        let numbers = match (&table.number, &table.combination) {
            (Some(number), None) => self.numbers(number, &format!("{key}.number"))?,
            (None, Some(sum)) => vec![self.combination(sum, key)?],
            _ => {
                let problem = "each [[want]] needs either number or combination";
                let remedy = "write number = \"BODY.mass_kg\", or combination = { \"BODY.inertia_kg_m2.xx\" = 1.0, ... }";
                return self.refused("E0507", key, problem, remedy);
            }
        };
        let stated = |want: Want| {
            let sigma = self.wanted_sigma(table, &want.terms, key)?;
            Some(Want { sigma, ..want })
        };
        Some(numbers.into_iter().filter_map(stated).collect())
    }

    fn wanted_sigma(&mut self, table: &WantFile, terms: &[WantedTerm], key: &str) -> Option<f64> {
        match (table.sigma, table.relative) {
            (Some(sigma), None) => Some(sigma),
            (None, Some(share)) => Some(share * self.scale(terms, key)?),
            _ => {
                let problem = "each [[want]] needs either sigma or relative";
                let remedy =
                    "write sigma = X in the unit of the number, or relative = X as a share of it";
                self.refused("E0507", key, problem, remedy)
            }
        }
    }

    /// Reference of `relative`: the mass, or the mean principal moment of the body.
    fn scale(&mut self, terms: &[WantedTerm], key: &str) -> Option<f64> {
        if let [term] = terms {
            let nominal = &self.model.bodies[term.body].nominal;
            match term.number {
                0 => return Some(nominal.mass),
                4.. => return Some(nominal.I_BBcm_B.trace() / 3.0),
                _ => {}
            }
        }
        let problem = "a mass centre or a combination has no natural scale";
        let key = format!("{key}.relative");
        self.refused("E0507", &key, problem, "give sigma in its unit")
    }

    fn combination(&mut self, sum: &BTreeMap<String, f64>, key: &str) -> Option<Want> {
        let key = format!("{key}.combination");
        let (mut names, mut terms, mut unit) = (Vec::new(), Vec::new(), None);
        for (address, factor) in sum {
            let found = self.numbers(address, &key)?;
            let [one] = found.as_slice() else {
                let problem = format!("\"{address}\" is a group of numbers");
                return self.refused("E0507", &key, problem, "name single numbers");
            };
            if unit.is_some_and(|u| u != one.unit) {
                let problem = "the numbers have different units";
                return self.refused("E0507", &key, problem, "add numbers of one unit");
            }
            unit = Some(one.unit);
            names.push(format!("{factor} {address}"));
            terms.extend(one.terms.iter().map(|t| WantedTerm {
                factor: *factor,
                ..*t
            }));
        }
        let Some(unit) = unit else {
            return self.refused("E0507", &key, "the combination is empty", "name numbers");
        };
        Some(Want {
            name: names.join(" + "),
            unit,
            terms,
            sigma: f64::NAN,
        })
    }

    /// The numbers of an address: `bus.mass_kg`, `bus.com_m.x`, `bus.com_m` (all three), ...
    fn numbers(&mut self, address: &str, key: &str) -> Option<Vec<Want>> {
        let known = all_numbers(self.model);
        let parts = Address::parse(address);
        let is_group = parts.component().is_none() && GROUPS.contains(&parts.quantity());
        let is_meant = |want: &&Want| {
            let rest = want.name.strip_prefix(address);
            rest.is_some_and(|r| r.is_empty() || (r.starts_with('.') && is_group))
        };
        let wanted: Vec<Want> = known.iter().filter(is_meant).cloned().collect();
        if wanted.is_empty() {
            let remedy = did_you_mean(address, known.iter().map(|want| want.name.as_str()));
            let problem = "the model has no number of this address";
            return self.refused("E0504", key, problem, remedy);
        }
        let mut terms = wanted.iter().flat_map(|want| &want.terms);
        if let Some(term) = terms.find(|term| !is_estimated(self.model, term)) {
            let name = &self.model.bodies[term.body].name;
            let problem = format!("\"{address}\" is known: body \"{name}\" does not estimate it");
            let remedy = "set estimate in the model, or leave the want out";
            return self.refused("E0507", key, problem, remedy);
        }
        Some(wanted)
    }
}

/// Every number estimated in the model, with infinite wanted sigma.
///
/// ```
#[doc = include_str!("../../doc/case.txt")]
/// // The six elements of its tensor.
/// assert_eq!(case::estimated_numbers(&model).len(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimated_numbers(model: &Model) -> Vec<Want> {
    let mut all = all_numbers(model);
    all.retain(|want| want.terms.iter().all(|term| is_estimated(model, term)));
    all
}

fn is_estimated(model: &Model, term: &WantedTerm) -> bool {
    model.bodies[term.body].estimate.has(term.number)
}

/// Every number of every body, with infinite wanted sigma.
fn all_numbers(model: &Model) -> Vec<Want> {
    let want = |body: usize, number: usize, name: String| Want {
        name,
        unit: MASS_PROPERTY_UNITS[number],
        terms: vec![WantedTerm {
            body,
            number,
            factor: 1.0,
        }],
        sigma: f64::NAN,
    };
    let mut all = Vec::new();
    for (body, own) in model.bodies.iter().enumerate() {
        let named = names(&own.name).into_iter().enumerate();
        all.extend(named.map(|(number, name)| want(body, number, name)));
    }
    all
}
