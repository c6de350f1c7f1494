//! Published methods, one paper each, run by the same command as the ladder and measured against it.

#![allow(non_snake_case)]

pub mod kim2010;
pub mod ma2008;
pub mod xu2017;

/// A published method and how it is called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Published {
    /// Name on the command line.
    pub name: &'static str,
    /// Variants; the first is taken where none is named.
    pub variants: &'static [&'static str],
    /// Where it was published.
    pub citation: &'static str,
}

/// Every published method that is there.
pub const PUBLISHED: [Published; 3] = [
    Published {
        name: "kim2010",
        variants: &[
            "suggested",
            "batch",
            "conventional",
            "pre-estimate",
            "iterated",
        ],
        citation: "Kim, Choi, Oh, J. Astron. Space Sci. 27(4), 2010, doi 10.5140/JASS.2010.27.4.353",
    },
    Published {
        name: "ma2008",
        variants: &["unknown-momentum", "known-momentum"],
        citation: "Ma, Dang, Pham, J. Guidance Control Dynamics 31(6), 2008, doi 10.2514/1.35188",
    },
    Published {
        name: "xu2017",
        variants: &["swarm", "linear", "swarm-inward", "linear-inward"],
        citation: "Xu, Hu, Zhang, Liang, Acta Astronautica, 2017",
    },
];

/// The published method of this name.
pub fn published(name: &str) -> Option<&'static Published> {
    PUBLISHED.iter().find(|p| p.name == name)
}
