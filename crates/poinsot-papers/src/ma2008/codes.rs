//! Error codes of this method: code, meaning, usual cause, remedy.

use crate::Explained;

pub(super) const CODES: &[Explained] = &[
    (
        "E0521",
        "ma2008 needs every body but the base known.",
        "estimate on a link.",
        "Take it out, or use --method auto.",
    ),
    (
        "E0522",
        "ma2008 identifies mass, mass centre and inertia of the base together.",
        "estimate = [\"mass\"] alone.",
        "Write estimate = true, or use --method auto.",
    ),
    (
        "E0523",
        "ma2008 needs an arm of known mass.",
        "The bodies beyond the base have no mass.",
        "Describe the arm, or use --method auto.",
    ),
    (
        "E0524",
        "ma2008, variant known-momentum, needs the momentum.",
        "both parts in [momentum] are \"estimate\".",
        "Give one or both in N, or use --variant unknown-momentum.",
    ),
    (
        "E0525",
        "ma2008 needs the velocity of the base.",
        "No channels v_x v_y v_z, and no velocity increments dv_x dv_y dv_z.",
        "Add one of them, or use --method maximum_likelihood.",
    ),
    (
        "E0526",
        "ma2008 assumes that momentum is conserved, and a thruster fires.",
        "A firing in the record.",
        "Cut it out, or use --method auto.",
    ),
    (
        "E0527",
        "ma2008 needs the spin inertia of wheels known.",
        "estimate on a wheel.",
        "Take it out, or use --method auto.",
    ),
    (
        "E0528",
        "ma2008 has too few samples for its unknowns.",
        "A record that was cut.",
        "Add samples at other arm configurations.",
    ),
    (
        "E0529",
        "ma2008: the equations hold a number that is not finite.",
        "Magnitudes near the limits of double precision.",
        "Check units and magnitudes.",
    ),
];
