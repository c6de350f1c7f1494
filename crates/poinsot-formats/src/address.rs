//! The address of a number, the same in result files, case files, plans, flags and Python: `bus.com_m.x`,
//! `bus.inertia_kg_m2.xx`, `gyro.bias_rad_s.x`, `wheel1.spin_inertia_kg_m2`, `thruster1.scale`.
//!
//! An address is the name of a body, joint, wheel, thruster or sensor, then a quantity with its unit, then a
//! component. In a case or model file it may also be a path of keys (`output.rate_hz`, `body.arm.mass_kg`,
//! `firing.0.on_s`). The estimator's names have owner, quantity and component (`bus.com_x`), with the unit kept
//! separately.

/// Components, the last step of an address.
const COMPONENTS: [&str; 11] = ["x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz", "1", "2"];

/// Mass properties: the estimator's name, and the key in files. Combinations of parameters use the first word of the
/// key.
const MASS_PROPERTIES: [(&str, &str); 8] = [
    ("m", "mass_kg"),
    ("mass", "mass_kg"),
    ("mc", "mc_kg_m"),
    ("com", "com_m"),
    ("I_BBo", "I_BBo_kg_m2"),
    ("I_BBcm", "inertia_kg_m2"),
    ("inertia", "inertia_kg_m2"),
    ("spin_inertia", "spin_inertia_kg_m2"),
];

/// The address of a number, from the estimator's name and unit.
///
/// ```
/// use poinsot_formats::address;
///
/// assert_eq!(address("bus.com_x", "m"), "bus.com_m.x");
/// assert_eq!(address("gyro.bias_x", "rad/s"), "gyro.bias_rad_s.x");
/// assert_eq!(address("hinge.stiffness", "N m/rad"), "hinge.stiffness_N_m_per_rad");
/// ```
pub fn address(name: &str, unit: &str) -> String {
    let (owner, what) = name.rsplit_once('.').unwrap_or(("", name));
    let (quantity, component) = match what.rsplit_once('_') {
        Some((quantity, last)) if COMPONENTS.contains(&last) => (quantity, Some(last)),
        _ => (what, None),
    };
    let owner = match owner {
        "" => String::new(),
        owner => format!("{owner}."),
    };
    let known = MASS_PROPERTIES.iter().find(|(word, _)| *word == quantity);
    let quantity = match (known, unit) {
        (Some((_, key)), _) => (*key).to_owned(),
        (None, "" | "1") => quantity.to_owned(),
        (None, unit) => format!("{quantity}_{}", words_of(unit)),
    };
    let component = component.map_or(String::new(), |c| format!(".{c}"));
    format!("{owner}{quantity}{component}")
}

/// A unit as the end of a key: `rad_s`, `N_m_per_rad`.
fn words_of(unit: &str) -> String {
    let per = match unit.rsplit_once('/') {
        Some((of, per @ ("rad" | "m"))) => format!("{of}_per_{per}"),
        _ => unit.to_owned(),
    };
    per.replace(['/', ' '], "_")
}

/// An address. Its steps are separated by dots; names may contain dots too.
///
/// ```
/// use poinsot_formats::Address;
///
/// let parts = Address::parse("bus.inertia_kg_m2.xx");
/// assert_eq!((parts.owner(), parts.quantity(), parts.component()), ("bus", "inertia_kg_m2", Some("xx")));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address<'a>(&'a str);

impl<'a> Address<'a> {
    /// Wraps the text of an address.
    pub fn parse(text: &'a str) -> Self {
        Self(text)
    }

    /// Its text.
    pub fn text(self) -> &'a str {
        self.0
    }

    /// Its steps: keys, names, components.
    pub fn steps(self) -> impl Iterator<Item = &'a str> {
        self.0.split('.')
    }

    /// Its first step.
    pub fn first(self) -> &'a str {
        self.steps().next().unwrap_or_default()
    }

    /// Every possible owner name, longest first, with the rest of the address.
    pub fn owners(self) -> impl Iterator<Item = (&'a str, Self)> {
        let dots = self.0.rmatch_indices('.');
        dots.map(move |(at, _)| (&self.0[..at], Self(&self.0[at + 1..])))
    }

    /// Name of a body, joint, wheel, thruster or sensor; empty without one.
    pub fn owner(self) -> &'a str {
        self.without_component()
            .rsplit_once('.')
            .map_or("", |p| p.0)
    }

    /// Quantity with its unit, as in files.
    pub fn quantity(self) -> &'a str {
        let text = self.without_component();
        text.rsplit_once('.').map_or(text, |p| p.1)
    }

    /// Component; `None` for a scalar or for all components.
    pub fn component(self) -> Option<&'a str> {
        let last = self.0.rsplit_once('.')?.1;
        COMPONENTS.contains(&last).then_some(last)
    }

    /// Owner, quantity and component, where the unit stands beside: `bus.inertia_xx`.
    pub fn without_unit(self, unit: &str) -> String {
        let end = format!("_{}", words_of(unit));
        let quantity = self.quantity();
        let quantity = quantity.strip_suffix(&end).unwrap_or(quantity);
        let component = self.component().map(|c| format!("_{c}"));
        let owner = match self.owner() {
            "" => String::new(),
            owner => format!("{owner}."),
        };
        format!("{owner}{quantity}{}", component.unwrap_or_default())
    }

    fn without_component(self) -> &'a str {
        let component = self.component();
        component.map_or(self.0, |c| &self.0[..self.0.len() - c.len() - 1])
    }
}

/// Index of a list element named by a step: x, y, z, w, or an integer from zero.
///
/// ```
/// use poinsot_formats::element;
///
/// assert_eq!((element("z"), element("10"), element("mass")), (Some(2), Some(10), None));
/// ```
pub fn element(step: &str) -> Option<usize> {
    let axis = ["x", "y", "z", "w"].iter().position(|a| *a == step);
    axis.or_else(|| step.parse().ok())
}

/// The estimator's name of an unknown mass property; the inverse of [`address`].
///
/// ```
/// use poinsot_formats::unknown_name;
///
/// assert_eq!(unknown_name("bus.inertia_kg_m2.xx"), "bus.I_BBcm_xx");
/// ```
pub fn unknown_name(address: &str) -> String {
    let parts = Address::parse(address);
    let (owner, quantity) = (parts.owner(), parts.quantity());
    let component = parts.component().map_or(String::new(), |c| format!("_{c}"));
    let known = MASS_PROPERTIES.iter().find(|(_, k)| *k == quantity);
    let word = known.map_or(quantity, |(word, _)| word);
    format!("{owner}.{word}{component}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_addresses_name_owner_quantity_unit_and_component() {
        for (name, unit, wanted) in [
            ("bus.mass", "kg", "bus.mass_kg"),
            ("bus.m", "kg", "bus.mass_kg"),
            ("bus.com_x", "m", "bus.com_m.x"),
            ("bus.inertia_xy", "kg m2", "bus.inertia_kg_m2.xy"),
            ("bus.I_BBo_zz", "", "bus.I_BBo_kg_m2.zz"),
            ("bus.mc_y", "kg m", "bus.mc_kg_m.y"),
            ("gyro.bias_x", "rad/s", "gyro.bias_rad_s.x"),
            ("my.gyro_x.bias_x", "rad/s", "my.gyro_x.bias_rad_s.x"),
            ("gyro.scale_y", "1", "gyro.scale.y"),
            ("gyro.lag", "s", "gyro.lag_s"),
            (
                "gyro.nonorthogonality_yz",
                "rad",
                "gyro.nonorthogonality_rad.yz",
            ),
            ("wheel1.misalignment_1", "rad", "wheel1.misalignment_rad.1"),
            ("wheel1.spin_inertia", "kg m2", "wheel1.spin_inertia_kg_m2"),
            (
                "environment.torque_inertial_x",
                "N m",
                "environment.torque_inertial_N_m.x",
            ),
        ] {
            assert_eq!(address(name, unit), wanted);
        }
    }

    #[test]
    fn exact_an_address_without_its_unit_is_the_name() {
        for (name, unit) in [
            ("../x.inertia_xx", "kg m2"),
            ("bus.mass", "kg"),
            ("my.gyro.bias_z", "rad/s"),
            ("gyro.scale_y", "1"),
            ("wheel1.spin_inertia", "kg m2"),
            ("orbit", "km"),
        ] {
            let address = address(name, unit);
            assert_eq!(Address::parse(&address).without_unit(unit), name);
        }
    }

    #[test]
    fn unit_an_address_comes_apart() {
        for (text, wanted) in [
            ("bus.com_m.x", ("bus", "com_m", Some("x"))),
            ("my.gyro.bias_rad_s.z", ("my.gyro", "bias_rad_s", Some("z"))),
            ("link1.mass_kg", ("link1", "mass_kg", None)),
            ("bus.com_m", ("bus", "com_m", None)),
            ("noise", ("", "noise", None)),
        ] {
            let address = Address::parse(text);
            let found = (address.owner(), address.quantity(), address.component());
            assert_eq!(found, wanted);
        }
        let owners: Vec<_> = Address::parse("my.gyro.lag_s").owners().collect();
        let wanted = [("my.gyro", "lag_s"), ("my", "gyro.lag_s")];
        assert_eq!(owners, wanted.map(|(name, rest)| (name, Address(rest))));
        assert_eq!(
            ["z", "w", "7", "xx"].map(element),
            [Some(2), Some(3), Some(7), None]
        );
    }

    #[test]
    fn exact_names_of_unknown_mass_properties_come_back() {
        for name in [
            "bus.m",
            "bus.mc_x",
            "bus.com_z",
            "bus.I_BBo_xy",
            "bus.I_BBcm_zz",
            "wheel1.spin_inertia",
            "thruster1.scale",
        ] {
            assert_eq!(unknown_name(&address(name, "")), name);
        }
    }
}
