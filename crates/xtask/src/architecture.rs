//! Draws docs/assets/architecture.svg: the flow of data, and the crates on their floors.

mod floors;

use crate::fault::Fault;
use crate::repository::{files_below, pattern, read, root, write};
use floors::{Floors, read_floors};

const PICTURE: &str = "docs/assets/architecture.svg";

/// One row of the flow: the command, its steps, and the row and column that its last step leads to.
struct Flow {
    command: &'static str,
    steps: &'static [Step],
    leads_to: Option<(usize, usize)>,
}

/// A type and its crate, or a file where there is no crate.
type Step = (&'static str, Option<&'static str>);

const FLOWS: [Flow; 5] = [
    Flow {
        command: "identify",
        steps: &[
            ("model.toml", None),
            ("Model", Some("poinsot-model")),
            ("Tree", Some("poinsot-dynamics")),
        ],
        leads_to: Some((1, 3)),
    },
    Flow {
        command: "",
        steps: &[
            ("telemetry", None),
            ("Table", Some("poinsot-telemetry")),
            ("Segment", Some("poinsot-identify")),
            ("Problem", Some("poinsot-identify")),
            ("Estimate", Some("poinsot-identify")),
            ("EstimateFile", Some("poinsot-formats")),
            ("estimate.json", None),
        ],
        leads_to: None,
    },
    Flow {
        command: "simulate",
        steps: &[
            ("case.toml", None),
            ("CaseFile", Some("poinsot-formats")),
            ("Scenario", Some("poinsot")),
            ("Plan", Some("poinsot-dynamics")),
            ("MotionSample", Some("poinsot-dynamics")),
            ("Table", Some("poinsot-telemetry")),
            ("telemetry.csv", None),
        ],
        leads_to: None,
    },
    Flow {
        command: "campaign",
        steps: &[
            ("plan.toml", None),
            ("Plan", Some("poinsot")),
            ("Trial", Some("poinsot")),
            ("Sums", Some("poinsot")),
            ("Folded", Some("poinsot")),
            ("CampaignFile", Some("poinsot-formats")),
            ("campaign.json", None),
        ],
        leads_to: None,
    },
    Flow {
        command: "validate",
        steps: &[
            ("two motions", None),
            ("Mover", Some("poinsot")),
            ("Compared", Some("poinsot")),
            ("Validation", Some("poinsot")),
            ("ValidationFile", Some("poinsot-formats")),
            ("validation.json", None),
        ],
        leads_to: None,
    },
];
const ALL_RESULTS: &str =
    "every result file: Document in the terminal, Page as HTML (poinsot-report, poinsot-figures)";

const WIDTH: usize = 960;
const LEFT: usize = 104;
const TOP: usize = 76;
const COLUMN: usize = 122;
const ROW: usize = 52;
const BOX: (usize, usize) = (104, 36);
const CRATE: (usize, usize) = (196, 38);
const BAND: usize = 50;
const INK: &str = "#1f2933";
const FAINT: &str = "#52606d";
const LINE: &str = "#9aa5b1";
const FILE: &str = "#ffffff";
const TYPE: &str = "#dcebf7";
const LANE: &str = "#eef1f4";

/// Writes the picture.
pub fn run() -> Result<(), Fault> {
    let drawn = drawn()?;
    write(&root().join(PICTURE), &drawn)?;
    println!("{PICTURE}: {} bytes", drawn.len());
    Ok(())
}

/// The picture, after a check that the types of the flow are defined in their crates.
fn drawn() -> Result<String, Fault> {
    for (name, holder) in FLOWS.iter().flat_map(|flow| flow.steps) {
        if let Some(holder) = holder {
            defined(name, holder)?;
        }
    }
    Ok(draw(&read_floors()?))
}

fn defined(name: &str, holder: &str) -> Result<(), Fault> {
    let definition = pattern(&format!(r"pub(\(\w+\))? (struct|enum) {name}\b"))?;
    for path in files_below(&root().join("crates").join(holder).join("src"))? {
        let is_rust = path.extension().is_some_and(|end| end == "rs");
        if is_rust && definition.is_match(&read(&path)?) {
            return Ok(());
        }
    }
    Err(Fault::Failed(format!(
        "architecture: {holder} defines no type {name}; correct FLOWS"
    )))
}

fn draw(floors: &Floors) -> String {
    let crates_top = TOP + FLOWS.len() * ROW + 76;
    let height = crates_top + floors.len() * BAND + 20;
    let mut parts = vec![
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
             font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">"
        ),
        "<title>What flows where in Poinsot, and the floors of its crates</title>".to_owned(),
        format!("<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>"),
        format!(
            "<defs><marker id=\"tip\" markerWidth=\"7\" markerHeight=\"7\" refX=\"6\" refY=\"3\" orient=\"auto\">\
             <path d=\"M0 0L6 3L0 6z\" fill=\"{LINE}\"/></marker></defs>"
        ),
        text(
            (24, 32),
            17,
            INK,
            "start",
            "Flow: files in white, types in blue with their crates",
        ),
    ];
    for (row, flow) in FLOWS.iter().enumerate() {
        parts.extend(draw_flow(row, flow));
    }
    let below = TOP + FLOWS.len() * ROW + 8;
    parts.push(text((LEFT, below), 12, FAINT, "start", ALL_RESULTS));
    parts.push(text(
        (24, crates_top - 16),
        17,
        INK,
        "start",
        "Floors: a crate imports only from floors below its own",
    ));
    for (floor, crates) in floors.iter().enumerate() {
        let y = crates_top + (floors.len() - 1 - floor) * BAND;
        parts.extend(draw_floor(y, floor, crates));
    }
    parts.push("</svg>\n".to_owned());
    parts.join("\n")
}

fn draw_flow(row: usize, flow: &Flow) -> Vec<String> {
    let (width, height) = BOX;
    let corner = |row: usize, column: usize| (LEFT + column * COLUMN, TOP + row * ROW - 18);
    let mut parts = vec![text(
        (24, TOP + row * ROW + 4),
        13,
        INK,
        "start",
        flow.command,
    )];
    for (column, (name, holder)) in flow.steps.iter().enumerate() {
        let (x, y) = corner(row, column);
        if column > 0 {
            let from = x + width - COLUMN;
            parts.push(arrow((from, y + height / 2), (x - 2, y + height / 2)));
        }
        let fill = if holder.is_some() { TYPE } else { FILE };
        parts.push(rectangle((x, y), BOX, fill));
        let middle = x + width / 2;
        let line = y + if holder.is_some() { 16 } else { 22 };
        parts.push(text((middle, line), 12, INK, "middle", name));
        if let Some(holder) = holder {
            parts.push(text((middle, y + 30), 10, FAINT, "middle", holder));
        }
    }
    if let Some((to_row, to_column)) = flow.leads_to {
        let (x, y) = corner(row, flow.steps.len() - 1);
        let (to_x, to_y) = corner(to_row, to_column);
        parts.push(arrow(
            (x + width, y + height / 2),
            (to_x + width / 2, to_y - 2),
        ));
    }
    parts
}

fn draw_floor(y: usize, floor: usize, crates: &[(String, &'static str)]) -> Vec<String> {
    let mut parts = vec![
        format!(
            "<rect x=\"24\" y=\"{y}\" width=\"{}\" height=\"{}\" fill=\"{LANE}\"/>",
            WIDTH - 48,
            BAND - 4
        ),
        text((44, y + 28), 13, FAINT, "middle", &floor.to_string()),
    ];
    for (k, (name, subject)) in crates.iter().enumerate() {
        let x = LEFT - 36 + k * (CRATE.0 + 12);
        let middle = x + CRATE.0 / 2;
        parts.push(rectangle((x, y + 4), CRATE, TYPE));
        parts.push(text((middle, y + 20), 12, INK, "middle", name));
        parts.push(text((middle, y + 35), 10, FAINT, "middle", subject));
    }
    parts
}

fn text((x, y): (usize, usize), size: usize, fill: &str, anchor: &str, words: &str) -> String {
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{fill}\" text-anchor=\"{anchor}\">{words}</text>"
    )
}

fn rectangle((x, y): (usize, usize), (width, height): (usize, usize), fill: &str) -> String {
    format!(
        "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" rx=\"3\" fill=\"{fill}\" stroke=\"{LINE}\"/>"
    )
}

fn arrow((x, y): (usize, usize), (to_x, to_y): (usize, usize)) -> String {
    format!("<path d=\"M{x} {y}L{to_x} {to_y}\" stroke=\"{LINE}\" marker-end=\"url(#tip)\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_the_picture_is_current() {
        let committed = read(&root().join(PICTURE)).unwrap();
        assert!(
            committed == drawn().unwrap(),
            "{PICTURE} is out of date; run scripts/architecture"
        );
    }

    #[test]
    fn unit_a_type_that_is_gone_is_noticed() {
        assert!(defined("Model", "poinsot-model").is_ok());
        assert!(defined("Mode", "poinsot-model").is_err());
    }
}
