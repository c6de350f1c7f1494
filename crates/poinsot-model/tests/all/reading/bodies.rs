//! Order, number and masses of bodies.

use super::{HEAD, accepted, body, joint, refused};
use poinsot_model::{describe, write_model};

#[test]
fn unit_bodies_are_sorted_parents_first_and_else_kept() {
    let mut text = HEAD.to_owned();
    for name in ["base", "c", "b", "a", "d"] {
        text += &body(name, 1.0);
    }
    text += &joint("jc", "revolute", "b", "c");
    text += &joint("jb", "revolute", "a", "b");
    text += &joint("ja", "revolute", "base", "a");
    text += &joint("jd", "revolute", "base", "d");
    let model = accepted(&text);
    let names: Vec<&str> = model.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["base", "a", "b", "c", "d"]);
    assert_eq!(model.joints[0].name, "jc");
    assert_eq!((model.joints[0].parent, model.joints[0].child), (2, 3));
    for (k, b) in model.bodies.iter().enumerate() {
        if let Some(j) = b.joint {
            assert_eq!(model.joints[j].child, k);
            assert!(model.joints[j].parent < k);
        }
    }
}

#[test]
fn unit_a_chain_of_ten_thousand_links_is_read_described_and_written() {
    let mut text = HEAD.to_owned();
    text += &body("b0", 1.0);
    for k in 1..10_000 {
        text += &body(&format!("b{k}"), 1.0);
    }
    // From the tip to the base: the result must not depend on file order.
    for k in (1..10_000).rev() {
        text += &joint(
            &format!("j{k}"),
            "revolute",
            &format!("b{}", k - 1),
            &format!("b{k}"),
        );
    }
    let model = accepted(&text);
    assert_eq!(model.bodies[9_999].name, "b9999");
    let words = describe(&model).to_string();
    assert!(words.contains("[9999] b9999"));
    assert_eq!(accepted(&write_model(&model)), model);
    text += &body("one too many", 1.0);
    assert!(refused(&text).starts_with("E0119 m.toml:"));
}

#[test]
fn unit_massless_bodies_may_carry_mass_or_be_carried_rigidly() {
    let base = format!("{HEAD}{}", body("base", 1.0));
    let wrist = base.clone()
        + &body("w", 0.0)
        + &body("tool", 1.0)
        + &joint("jw", "revolute", "base", "w")
        + &joint("jt", "revolute", "w", "tool");
    assert_eq!(accepted(&wrist).bodies[1].nominal.mass, 0.0);
    let frame = base.clone() + &body("f", 0.0) + &joint("jf", "fixed", "base", "f");
    accepted(&frame);
    let flag = base
        + &body("f", 0.0)
        + &body("g", 0.0)
        + &joint("jf", "fixed", "base", "f")
        + &joint("jg", "revolute", "f", "g");
    assert!(refused(&flag).contains("E0116"));
    let ghost = format!("{HEAD}{}", body("base", 0.0));
    assert_eq!(
        refused(&ghost),
        "E0116 m.toml:4:11: body[0].mass_kg (body \"base\") = 0.0: no body of the vehicle has mass; give the base a mass"
    );
}
