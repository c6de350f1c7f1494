//! Header lines of real systems: what their names alone say.

use poinsot_telemetry::{Kind, recognise};

/// Names as public repositories write them, and the channel of each.
const HEADERS: &str = include_str!("headers.tsv");
/// The same, collected after the vocabulary was written.
const LATER: &str = include_str!("headers_later.tsv");
/// Of simulators, mission tools and autopilots.
const PUBLIC: &str = include_str!("headers_public.tsv");

/// What a name was taken for: its channel without the sensor, the form of an attitude whose order or unit is open, or "-".
fn taken(header: &[String]) -> Vec<String> {
    let found = recognise(header, &[]);
    let mut all = vec!["-".to_owned(); header.len()];
    for one in &found.channels {
        let channel = one.channel.rsplit('.').next().unwrap();
        all[one.column] = match one.kind {
            Kind::Quaternion if !one.named => "q".to_owned(),
            Kind::Euler => "euler".to_owned(),
            Kind::Rodrigues => "mrp".to_owned(),
            _ => channel.to_owned(),
        };
    }
    all
}

/// Channels, those recognised, and columns taken for something else.
fn count(headers: &str) -> (usize, usize, Vec<String>, Vec<String>) {
    let lines: Vec<&str> = headers.lines().skip(1).collect();
    let (mut channels, mut recognised, mut wrong) = (0, 0, Vec::new());
    let mut missed = Vec::new();
    for three in lines.chunks(3) {
        let split = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
        let (header, wanted) = (split(three[1]), split(three[2]));
        for ((name, wanted), taken) in header.iter().zip(&wanted).zip(taken(&header)) {
            channels += usize::from(wanted != "-");
            recognised += usize::from(wanted != "-" && *wanted == taken);
            if taken != "-" && *wanted != taken {
                wrong.push(format!(
                    "{}: {name} is {wanted}, taken for {taken}",
                    three[0]
                ));
            } else if *wanted != taken {
                missed.push(format!("{}: {name}", three[0]));
            }
        }
    }
    (channels, recognised, wrong, missed)
}

/// At least 90 % of the channels are recognised, and no column is taken for something that it is not.
#[test]
fn xval_names_of_forty_real_headers() {
    let (channels, recognised, wrong, missed) = count(HEADERS);
    assert!(HEADERS.lines().count() / 3 >= 40);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(recognised as f64 >= 0.9 * channels as f64, "{missed:#?}");
    // The figure that the changelog states.
    assert_eq!((recognised, channels), (379, 382), "{missed:#?}");
}

/// The same of headers that the vocabulary was not made for.
#[test]
fn xval_names_of_headers_collected_later() {
    let (channels, recognised, wrong, missed) = count(LATER);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(recognised as f64 >= 0.9 * channels as f64, "{missed:#?}");
    assert_eq!((recognised, channels), (124, 128), "{missed:#?}");
}

/// The same of public systems, with the letters of flight mechanics.
#[test]
fn xval_names_of_public_systems() {
    let (channels, recognised, wrong, missed) = count(PUBLIC);
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert_eq!((recognised, channels), (90, 95), "{missed:#?}");
}

/// Letters p, q, r are body rates only where all three stand alone, and of one owner.
#[test]
fn prop_one_letter_of_three_is_no_body_rate() {
    for header in ["t p q", "t q r", "t p q r p", "t a_p b_q c_r", "t p1 q2 r3"] {
        let header: Vec<String> = header.split(' ').map(str::to_owned).collect();
        let taken = taken(&header);
        assert!(!taken.iter().any(|c| c.starts_with("omega")), "{taken:?}");
    }
}
