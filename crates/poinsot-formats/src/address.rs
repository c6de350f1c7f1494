//! The address of a number, the same in result files, case files, plans, flags and Python: `bus.com_m.x`,
//! `bus.inertia_kg_m2.xx`, `gyro.bias_rad_s.x`, `wheel1.spin_inertia_kg_m2`, `thruster1.scale`.
//!
//! An address is the name of a body, joint, wheel, thruster or sensor, then a quantity with its unit, then a component.
//! The estimator calls a number by owner, quantity and component alone (`bus.com_x`), with the unit beside the name.

/// Last steps of an address.
const COMPONENTS: [&str; 11] = ["x", "y", "z", "xx", "yy", "zz", "xy", "xz", "yz", "1", "2"];

/// Mass properties: the estimator's word, and the key in files. The first word of a key is the one that combinations of
/// parameters use.
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

/// The address of a number with the name and unit that the estimator gives it.
pub fn address(name: &str, unit: &str) -> String {
    let (owner, what) = name.rsplit_once('.').unwrap_or(("", name));
    let (quantity, component) = match what.rsplit_once('_') {
        Some((quantity, last)) if COMPONENTS.contains(&last) => (quantity, Some(last)),
        _ => (what, None),
    };
    let mut out = match owner {
        "" => String::new(),
        owner => format!("{owner}."),
    };
    let known = MASS_PROPERTIES.iter().find(|(word, _)| *word == quantity);
    match (known, unit) {
        (Some((_, key)), _) => out.push_str(key),
        (None, "" | "1") => out.push_str(quantity),
        (None, unit) => {
            out.push_str(quantity);
            out.push('_');
            out.push_str(&unit.replace(['/', ' '], "_"));
        }
    }
    if let Some(component) = component {
        out.push('.');
        out.push_str(component);
    }
    out
}

/// An address in its parts: the one parser of addresses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Address<'a> {
    /// Name of a body, joint, wheel, thruster or sensor, which may hold dots; empty without one.
    pub owner: &'a str,
    /// Quantity with its unit, as in files.
    pub quantity: &'a str,
    /// Component; `None` of a scalar, or of all components.
    pub component: Option<&'a str>,
}

impl<'a> Address<'a> {
    /// Takes an address apart.
    pub fn parse(text: &'a str) -> Self {
        let (rest, component) = match text.rsplit_once('.') {
            Some((rest, last)) if COMPONENTS.contains(&last) => (rest, Some(last)),
            _ => (text, None),
        };
        let (owner, quantity) = rest.rsplit_once('.').unwrap_or(("", rest));
        Self {
            owner,
            quantity,
            component,
        }
    }
}

/// The estimator's name of an unknown mass property, from its address; the inverse of [`address`].
pub fn unknown_name(address: &str) -> String {
    let Address {
        owner,
        quantity,
        component,
    } = Address::parse(address);
    let component = component.map_or(String::new(), |c| format!("_{c}"));
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
