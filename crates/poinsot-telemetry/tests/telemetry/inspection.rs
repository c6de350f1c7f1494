//! What the inspection of a table says.

use crate::read_text;
use poinsot_telemetry::{ReadOptions, inspect};

#[test]
fn unit_an_inspection_lists_rates_gaps_and_proposals() {
    let mut text = String::from("time_s,omega_x,wheel1_rad_s,wy [deg/s],Mode\n");
    for k in (0..200).filter(|k| !(100..110).contains(k)) {
        let sentinel = if k % 50 == 7 {
            -9999.0
        } else {
            f64::from(k % 17) * 0.25
        };
        text.push_str(&format!(
            "{},{sentinel},6000,1,nominal\n",
            f64::from(k) * 0.1
        ));
    }
    let table = read_text(text, &ReadOptions::default()).unwrap();
    let seen = inspect(&table);
    let x = &seen.channels[0];
    assert_eq!((x.samples, x.gaps, x.quantum), (190, 1, Some(0.25)));
    assert!((x.longest_gap_s - 1.1).abs() < 1e-12 && (x.rate_hz.unwrap() - 10.0).abs() < 1e-9);
    assert!(seen.channels[1].constant);
    assert_eq!(seen.ignored, ["wy [deg/s]", "Mode"]);
    assert_eq!(
        seen.suggestions[0].toml,
        "omega_y = { column = \"wy [deg/s]\", unit = \"deg/s\" }"
    );
    assert_eq!(
        seen.notes,
        [
            "wheel1_rad_s reaches 6000 rad/s (57296 rpm); if the file holds rpm, map it with unit = \"rpm\". Attitude and gyro cannot tell",
        ]
    );
    let found: Vec<&str> = seen.findings.iter().map(|f| f.text.as_str()).collect();
    assert_eq!(
        found.last(),
        Some(
            &"-9999 stands in 3 samples, far from all others: a placeholder for no sample? leave those cells empty, or --policy placeholder=exclude"
        )
    );
    let shown = seen.to_string();
    assert!(shown.contains("omega_x") && shown.contains("Columns not taken:\n  wy [deg/s], Mode"));
    let json = serde_json::to_value(&seen).unwrap();
    assert_eq!(json["channels"][0]["name"], "omega_x");
}
