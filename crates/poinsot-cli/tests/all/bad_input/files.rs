//! 2c: files.

use crate::bad_input::bench::{Bench, MODEL, sheet};
use crate::bad_input::row::{IDENTIFY, Row, row};

const PARQUET: &[&str] = &[
    "identify",
    "--model",
    "m.toml",
    "--telemetry",
    "t.parquet",
    "--out",
    "out",
];
const INSPECT_PARQUET: &[&str] = &["inspect", "t.parquet"];
const INSPECT: &[&str] = &["inspect", "t.csv"];

fn bytes() -> Vec<u8> {
    sheet().text().into_bytes()
}

fn header(b: &Bench, change: impl Fn(&str) -> String) {
    let text = sheet().text();
    let (first, rest) = text.split_once('\n').unwrap();
    b.write("t.csv", format!("{}\n{rest}", change(first)));
}

/// The valid telemetry as Parquet.
fn parquet(b: &Bench) -> Vec<u8> {
    let table = poinsot_telemetry::read(
        &[b.path("t.csv")],
        &poinsot_telemetry::ReadOptions::default(),
    )
    .unwrap();
    let path = b.path("t.parquet");
    poinsot_telemetry::write(&path, &table.channels).unwrap();
    std::fs::read(path).unwrap()
}

fn spoilt(b: &Bench, change: impl Fn(&mut Vec<u8>)) {
    let mut bytes = parquet(b);
    change(&mut bytes);
    b.write("t.parquet", bytes);
}

pub fn rows() -> Vec<Row> {
    let mut all = csv();
    all.extend(parquet_rows());
    all.extend(toml());
    all
}

/// Long telemetry whose modification time changes while the program reads; its content does not.
fn touched(b: &Bench) {
    let mut text = sheet().text();
    for k in 0..100_000 {
        text.push_str(&format!("{}.0,0,0,0,,,,,0,0,0\n", 101 + k));
    }
    b.write("t.csv", text);
    let path = b.path("t.csv");
    std::thread::spawn(move || {
        let mut time = std::time::SystemTime::UNIX_EPOCH;
        // Until the folder is removed.
        while let Ok(file) = std::fs::File::options().append(true).open(&path) {
            time += std::time::Duration::from_secs(1);
            if file.set_modified(time).is_err() {
                break;
            }
        }
    });
}

/// A pipe without writer.
fn pipe(b: &Bench, name: &str) {
    let made = std::process::Command::new("mkfifo")
        .arg(b.path(name))
        .status();
    assert!(made.is_ok_and(|s| s.success()));
}

/// A file with page checksums and one changed byte.
fn bad_page(b: &Bench) {
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../poinsot-telemetry/tests/data/checksums_v1.parquet");
    let mut bytes = std::fs::read(data).unwrap();
    bytes[BAD_BYTE] ^= 1;
    b.write("t.parquet", bytes);
}

/// In a page of `omega_x` in the second half of the rows.
const BAD_BYTE: usize = 8000;

/// A file of the fuzz corpus.
fn corpus(b: &Bench, name: &str) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/parquet");
    b.write("t.parquet", std::fs::read(folder.join(name)).unwrap());
}

fn csv() -> Vec<Row> {
    vec![
        row("F1", "cut inside the last row", |b| { let t = bytes(); b.write("t.csv", &t[..t.len() - 60]); }, 2,
            &["E0206 t.csv:502: the file ends inside this row (", "use --recover to keep the rows before it"]),
        row("F1", "the same, recovered", |b| { let t = bytes(); b.write("t.csv", &t[..t.len() - 60]); }, 0, &["t.csv:502: cut last row dropped"]).more(&["--recover"]),
        row("F1", "cut inside the last number", |b| { let t = bytes(); b.write("t.csv", &t[..t.len() - 4]); }, 0, &["the last row has no line end; assumed complete"]),
        row("F1", "the same, recovered", |b| { let t = bytes(); b.write("t.csv", &t[..t.len() - 4]); }, 0, &["last row dropped: it has no line end, so its last number may be cut"]).more(&["--recover"]),
        row("F1", "cut inside a quote", |b| { let mut t = bytes(); t.extend(b"100.2,\"0.1"); b.write("t.csv", t); }, 2, &["E0206 t.csv:503"]),
        row("F1", "cut inside a UTF-8 sequence", |b| { let mut t = bytes(); t.extend(b"100.2,\xc3"); b.write("t.csv", t); }, 2, &["E0206 t.csv:503"]),
        row("F2", "a row with a field too many", |b| b.spoil(|s| s.rows[4].push("1".into())), 2, &["E0204 t.csv:6: 12 fields where the header has 11: a decimal comma or a comma in a text without quotes adds fields; write a point, or quotes around the text"]),
        row("F2", "a row with a field too few", |b| b.spoil(|s| { s.rows[4].pop(); }), 2, &["E0204 t.csv:6: 10 fields where the header has 11; complete the row: an empty cell means no sample"]),
        row("F2", "a column name twice", |b| header(b, |h| h.replace("omega_y", "omega_x")), 2, &["E0205 t.csv: column 'omega_x' is twice in the header; rename one"]),
        row("F2", "no header", |b| header(b, |_| "0,0,0,0,0,0,0,1,0,0,0".replace("0,0,0,0,0,0,0,1,0,0,0", "0,1,2,3,4,5,6,7,8,9,10")), 2, &["E0207 t.csv: no column 'time_s'"]),
        row("F2", "names with blanks and units", |b| header(b, |h| h.replace("omega_x", "Gyro X [rad/s]")), 2, &["E0301 t.csv: no channel 'omega_x omega_y omega_z'"]),
        row("F2", "names in capitals", |b| header(b, |h| h.replace("omega", "OMEGA")), 2, &["E0301 t.csv: no channel 'omega_x omega_y omega_z'"]),
        row("F2", "a wheel's column is missing", |b| b.spoil(|s| s.without("wheel2")), 2, &["E0301 t.csv: no channel 'wheel2_rad_s': the momentum of a wheel has no default"]),
        row("F3", "UTF-8 byte order mark and CRLF", |b| { let t = sheet().text().replace('\n', "\r\n"); b.write("t.csv", format!("\u{feff}{t}")); }, 0, &[": Determined. "]),
        row("F3", "lone CR", |b| b.write("t.csv", sheet().text().replace('\n', "\r")), 0, &[": Determined. "]),
        row("F3", "UTF-16", |b| { let t: Vec<u8> = [0xfeff].into_iter().chain(sheet().text().encode_utf16()).flat_map(u16::to_le_bytes).collect(); b.write("t.csv", t); }, 2, &["E0202 t.csv: the file is UTF-16; save it as UTF-8"]),
        row("F3", "UTF-16, big end first", |b| { let t: Vec<u8> = [0xfeff].into_iter().chain(sheet().text().encode_utf16()).flat_map(u16::to_be_bytes).collect(); b.write("t.csv", t); }, 2, &["E0202 t.csv: the file is UTF-16; save it as UTF-8"]),
        row("F3", "line ends of all kinds", |b| { let t: String = sheet().text().lines().enumerate().map(|(n, l)| format!("{l}{}", ["\n", "\r\n", "\r"][n % 3])).collect(); b.write("t.csv", t); }, 0, &[": Determined. "]),
        row("F3", "NUL bytes", |b| { let mut t = bytes(); t[500] = 0; b.write("t.csv", t); }, 2, &["E0202 t.csv: byte 500 is NUL: the file is not text, or is UTF-16; save it as UTF-8"]),
        row("F3", "semicolons", |b| b.write("t.csv", sheet().text().replace(',', ";")), 2, &["E0205 t.csv: the columns are separated by ';'; write [telemetry] delimiter = \";\""]),
        row("F3", "tabs", |b| b.write("t.csv", sheet().text().replace(',', "\t")), 2, &["E0205 t.csv: the columns are separated by '\\t'"]),
        row("F3", "a comma at the end of each row", |b| b.write("t.csv", sheet().text().replace('\n', ",\n")), 0, &[": Determined. "]),
        row("F3", "a comment", |b| b.spoil(|s| s.rows.insert(3, vec!["# comment".into()])), 2, &["E0204 t.csv:5", "leave the line out, or write [telemetry] comment = \"#\""]),
        row("F4", "a Latin-1 header", |b| { let t = sheet().text().replacen("wheel3_rad_s", "wheel3_rad_s,temp_\u{b0}C", 1).replace('\n', ",\n").replacen("C,\n", "C\n", 1); let t: Vec<u8> = t.chars().map(|c| c as u8).collect(); b.write("t.csv", t); }, 2,
            &["E0202 t.csv:1: the header is not UTF-8 ('temp_", "read it by --encoding latin1"]),
        row("F4", "the same, read as Latin-1", |b| { let t = sheet().text().replacen("wheel3_rad_s", "wheel3_rad_s,temp_\u{b0}C", 1).replace('\n', ",\n").replacen("C,\n", "C\n", 1); let t: Vec<u8> = t.chars().map(|c| c as u8).collect(); b.write("t.csv", t); }, 0,
            &[": Determined. "]).more(&["--encoding", "latin1"]),
        row("F4", "a Latin-1 byte in a number", |b| { let mut t = bytes(); let at = t.iter().position(|&c| c == b'\n').unwrap(); t.splice(at + 5..at + 5, [0xb0]); b.write("t.csv", t); }, 2, &["E0203 t.csv:2", "is not UTF-8 text; save the file as UTF-8"]),
        row("F5", "decimal comma in quotes", |b| b.spoil(|s| s.set(3, "omega_x", "\"1,5\"")), 2, &["E0203 t.csv:5 column 'omega_x': '1,5' has a decimal comma; write a point"]),
        row("F5", "decimal comma without quotes", |b| b.spoil(|s| s.set(3, "omega_x", "1,5")), 2, &["E0204 t.csv:5", "a decimal comma"]),
        row("F5", "thousands: 1.234,5", |b| b.spoil(|s| s.set(3, "omega_x", "\"1.234,5\"")), 2, &["E0203 t.csv:5 column 'omega_x': '1.234,5' has a decimal comma; write a point"]),
        row("F5", "+.5 and 007 are numbers", |b| b.spoil(|s| { let x = s.get(3, "wheel1_rad_s"); s.set(3, "wheel1_rad_s", format!("+00{x:?}")); s.set(0, "wheel1_rad_s", "+.0"); }), 0, &[": Determined. "]),
        row("F5", "1_000", |b| b.spoil(|s| s.set(3, "omega_x", "1_000")), 2, &["has '_' between digits; leave it out"]),
        row("F5", "hexadecimal", |b| b.spoil(|s| s.set(3, "omega_x", "0x1p3")), 2, &["is hexadecimal; write a decimal number"]),
        row("F5", "1e400", |b| b.spoil(|s| s.set(3, "omega_x", "1e400")), 2, &["E0203 t.csv:5 column 'omega_x': '1e400' is too large for a double; correct the number"]),
        row("F5", "Fortran's 1d-3", |b| b.spoil(|s| s.set(3, "omega_x", "1d-3")), 2, &["has a Fortran exponent; write 'e'"]),
        row("F5", "typographic minus", |b| b.spoil(|s| s.set(3, "omega_x", "\u{2212}0.01")), 2, &["has a typographic minus (U+2212); write the ASCII '-'"]),
        row("F6", "one line of 17 MiB", |b| b.write("t.csv", "a".repeat(17 << 20)), 2, &["E0202 t.csv: a line is longer than 16 MiB"]),
        row("F6", "70,000 columns", |b| b.write("t.csv", format!("time_s{}\n", (0..70_000).map(|k| format!(",c{k}")).collect::<String>())), 2, &["E0205 t.csv: 70001 columns in the header; leave out what is not needed, the limit is 65536"]),
        row("F6", "more samples than the memory allowed", |b| { let mut t = sheet().text(); let tail = ",0,0,0,,,,,0,0,0\n"; for k in 0..20_000 { t.push_str(&format!("{}{tail}", 101 + k)); } b.write("t.csv", t); }, 2,
            &["E0221 t.csv: up to ", "samples in 10 channels are requested, but 10922 fit into 1 MiB of memory; use --every", "--time-s FROM,TO, or a larger --memory-mib"]).more(&["--memory-mib", "1"]),
        row("F6", "a part of the record", |_| {}, 0, &["t.csv: 151 of 501 rows selected by --time-s and --every"]).more(&["--time-s", "20,80", "--every", "2"]),
        row("F6", "no row in the part", |_| {}, 2, &["E0213 where time_s = '200,300': no row of t.csv lies between these times, s; choose times of the record"]).more(&["--time-s", "200,300"]),
        row("F6", "a folder", |b| { std::fs::remove_file(b.path("t.csv")).unwrap(); std::fs::create_dir(b.path("t.csv")).unwrap(); }, 2, &["E0202 t.csv: not a regular file; give a .csv or .parquet file"]),
        row("F6", "a pipe", |b| { std::fs::remove_file(b.path("t.csv")).unwrap(); let made = std::process::Command::new("mkfifo").arg(b.path("t.csv")).status(); assert!(made.is_ok_and(|s| s.success())); }, 2, &["E0202 t.csv: not a regular file"]),
        row("F6", "a sparse file of 10 GB", |b| std::fs::File::create(b.path("t.csv")).unwrap().set_len(10 << 30).unwrap(), 2, &["E0202 t.csv: byte 0 is NUL"]),
        row("F7", "the file changes while it is read", touched, 2, &["E0202 t.csv: the file changed during reading; use it when it is complete"]),
        row("F6", "/dev/zero as the model", |_| {}, 2, &["E0101 /dev/zero: this is not a regular file; name a file"]).run(&["identify", "--model", "/dev/zero", "--telemetry", "t.csv", "--out", "out"]),
        row("F6", "/dev/zero as the case", |_| {}, 2, &["E0501 /dev/zero: this is not a regular file; name a file"]).run(&["simulate", "/dev/zero", "--out", "sim"]),
        row("F6", "a pipe as the case", |b| pipe(b, "case.toml"), 2, &["E0501 case.toml: this is not a regular file; name a file"]).run(&["predict", "case.toml"]),
        row("F6", "a pipe as the model", |b| { std::fs::remove_file(b.path("m.toml")).unwrap(); pipe(b, "m.toml"); }, 2, &["E0101 m.toml: this is not a regular file; name a file"]).run(&["check", "m.toml"]),
        row("F6", "a pipe as the URDF", |b| pipe(b, "r.urdf"), 2, &["E0101 r.urdf: this is not a regular file; name a file"]).run(&["import", "r.urdf"]),
        row("F6", "a pipe as the estimate", |b| { std::fs::create_dir(b.path("out")).unwrap(); pipe(b, "out/estimate.json"); }, 2, &["E0601 out/estimate.json: no report or export can be made of this: this is not a regular file; name a file"]).run(&["report", "out"]),
        row("F6", "a pipe as the estimate of a validation", |b| pipe(b, "e.json"), 2, &["E0701 e.json: this estimate cannot be simulated: this is not a regular file; give "]).run(&["validate", "--model", "m.toml", "--estimate", "e.json", "--against", "t.csv"]),
        row("F6", "a pipe where the truth of a simulation would be", |b| pipe(b, "truth.json"), 0, &[": Determined. "]),
        row("F6", "a link to itself", |b| { std::fs::remove_file(b.path("t.csv")).unwrap(); std::os::unix::fs::symlink("t.csv", b.path("t.csv")).unwrap(); }, 3, &["E0201 t.csv: cannot be read:"]),
        row("F6", "no such file", |b| std::fs::remove_file(b.path("t.csv")).unwrap(), 2, &["E0201 t.csv: cannot be read: No such file or directory"]),
        row("F6", "plain text under the name of a packed file", |b| std::fs::rename(b.path("t.csv"), b.path("t.csv.gz")).unwrap(), 0, &[": Determined. "]).run(&["identify", "--model", "m.toml", "--telemetry", "t.csv.gz", "--out", "out"]),
        row("F9", "MCAP (not read)", |b| b.write("t.mcap", b"\x89MCAP0\r\n"), 2, &["E0202 t.mcap: the kind of file is not known from its name; give a .csv, .csv.gz, .csv.zst or .parquet file"]).run(&["inspect", "t.mcap"]),
        row("F3", "inspect names the header's fault too", |b| b.write("t.csv", "a;b\n1;2\n"), 2, &["E0205 t.csv"]).run(INSPECT),
    ]
}

fn parquet_rows() -> Vec<Row> {
    vec![
        row(
            "F8",
            "good Parquet",
            |b| spoilt(b, |_| {}),
            0,
            &[": Determined. "],
        )
        .run(PARQUET),
        row(
            "F8",
            "cut in half",
            |b| spoilt(b, |p| p.truncate(p.len() / 2)),
            2,
            &[
                "E0216 t.parquet:",
                "write the file again, or convert it to CSV",
            ],
        )
        .run(PARQUET),
        row(
            "F8",
            "the first byte only",
            |b| spoilt(b, |p| p.truncate(1)),
            2,
            &["E0216 t.parquet:"],
        )
        .run(PARQUET),
        row(
            "F8",
            "empty",
            |b| spoilt(b, Vec::clear),
            2,
            &["E0216 t.parquet:"],
        )
        .run(PARQUET),
        row(
            "F8",
            "a column of lists",
            |b| corpus(b, "types.parquet"),
            2,
            &[
                "E0216 t.parquet column 'v_x': type List(",
                "is not supported; store numbers as float64, times as seconds",
            ],
        )
        .run(INSPECT_PARQUET),
        row(
            "F8",
            "no rows",
            |b| corpus(b, "empty.parquet"),
            2,
            &["E0217 t.parquet: no data rows after the header; give a file with samples"],
        )
        .run(INSPECT_PARQUET),
        row(
            "F8",
            "one bit flipped",
            |b| corpus(b, "flip.parquet"),
            2,
            &[
                "E0216 t.parquet: Parquet",
                "write the file again, or convert it to CSV",
            ],
        )
        .run(INSPECT_PARQUET),
        row(
            "F8",
            "a byte of a page with a checksum",
            bad_page,
            2,
            &[
                "E0216 t.parquet row ",
                "the page of this row does not match its checksum: its bytes were changed; the rows before it can be kept by --recover; write the file again",
            ],
        )
        .run(INSPECT_PARQUET),
        row(
            "F8",
            "the same, recovered",
            bad_page,
            0,
            &["rows from here on dropped: a page does not match its checksum"],
        )
        .run(INSPECT_PARQUET)
        .more(&["--recover"]),
        row(
            "F8",
            "wrong magic",
            |b| {
                spoilt(b, |p| {
                    let n = p.len();
                    p[n - 1] = b'X';
                })
            },
            2,
            &["E0216 t.parquet:"],
        )
        .run(PARQUET),
        row(
            "F8",
            "a footer length beyond the file",
            |b| {
                spoilt(b, |p| {
                    let n = p.len();
                    p[n - 8..n - 4].copy_from_slice(&0x7fff_ffff_u32.to_le_bytes());
                })
            },
            2,
            &["E0216 t.parquet:"],
        )
        .run(PARQUET),
        row(
            "F8",
            "CSV under the name of Parquet",
            |b| {
                let t = bytes();
                b.write("t.parquet", t);
            },
            2,
            &["E0216 t.parquet:"],
        )
        .run(PARQUET),
    ]
}

fn toml() -> Vec<Row> {
    vec![
        row(
            "F10",
            "100,000 numbers where three stand",
            |b| {
                b.model(
                    "com_m = [0.0, 0.0, 0.0]",
                    &format!("com_m = [{}0.0]", "0.0, ".repeat(100_000)),
                )
            },
            2,
            &["E0107 m.toml:7:9: body[0].com_m"],
        ),
        row(
            "F10",
            "a key twice",
            |b| b.model("mass_kg = 150.0", "mass_kg = 150.0\nmass_kg = 151.0"),
            2,
            &["E0102 m.toml:7:1: not valid TOML: duplicate key; correct it here"],
        ),
        row(
            "F10",
            "an unknown key",
            |b| b.model("com_m =", "comm_m ="),
            2,
            &[
                "E0104 m.toml:7:1: body[0].comm_m (body \"bus\")",
                "did you mean com_m?",
            ],
        ),
        row(
            "F10",
            "a wrong type",
            |b| b.model("mass_kg = 150.0", "mass_kg = \"heavy\""),
            2,
            &[
                "E0107 m.toml:6:11: body[0].mass_kg (body \"bus\") = \"heavy\": text is here, but another type is needed; write a number",
            ],
        ),
        row(
            "F10",
            "a key without unit",
            |b| b.model("mass_kg = 150.0", "mass = 150.0"),
            2,
            &["E0105 m.toml:6:1: body[0].mass (body \"bus\")"],
        ),
        row(
            "F10",
            "a date",
            |b| b.model("mass_kg = 150.0", "mass_kg = 2024-01-01"),
            2,
            &["E0107", "a date is here, but another type is needed"],
        ),
        row(
            "F10",
            "10,000 brackets",
            |b| {
                b.write(
                    "m.toml",
                    format!("schema = \"poinsot.model/1\"\nx = {}", "[".repeat(10_000)),
                )
            },
            2,
            &["E0102 m.toml:2"],
        ),
        row(
            "F10",
            "NaN",
            |b| b.model("mass_kg = 150.0", "mass_kg = nan"),
            2,
            &[
                "E0108 m.toml:6:11: body[0].mass_kg (body \"bus\") = nan: the number is not finite; write a finite number",
            ],
        ),
        row(
            "F10",
            "no such model",
            |b| std::fs::remove_file(b.path("m.toml")).unwrap(),
            2,
            &["E0101 m.toml: there is no such file; check the path"],
        ),
        row(
            "F10",
            "the model is larger than 16 MiB",
            |b| b.write("m.toml", "#".repeat((16 << 20) + 1)),
            2,
            &["E0101 m.toml: the file is larger than 16 MiB; name a file of the right kind"],
        ),
        row(
            "F10",
            "the model is not UTF-8",
            |b| b.write("m.toml", b"schema = \"\xb0\""),
            2,
            &["E0101 m.toml: byte 10 is not UTF-8; save the file as UTF-8 text"],
        ),
        row(
            "F10",
            "a case is given as the model",
            |b| b.write("m.toml", "schema = \"poinsot.case/1\"\n"),
            2,
            &[
                "E0103 m.toml:1:10: schema = \"poinsot.case/1\": this program does not support this format; write schema = \"poinsot.model/1\"",
            ],
        ),
        row(
            "F10",
            "a missing key",
            |b| b.model("mass_kg = 150.0\n", ""),
            2,
            &["E0106 m.toml:"],
        ),
        row(
            "F10",
            "an empty model",
            |b| b.write("m.toml", ""),
            2,
            &["E0103 m.toml:1:1: the file is empty"],
        )
        .run(IDENTIFY),
        row(
            "F10",
            "no sensors",
            |b| b.write("m.toml", MODEL.split("[[sensor]]").next().unwrap()),
            2,
            &["E0302 model: no sensor of type 'gyro' declares its noise"],
        ),
    ]
}
