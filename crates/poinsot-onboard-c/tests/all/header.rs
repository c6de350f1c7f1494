//! The header against the Rust declarations, by a C compiler: sizes, offsets, constants and the types of all functions.

use poinsot_onboard_c::*;
use std::fmt::Write;
use std::mem::offset_of;
use std::process::Command;

/// The name of a type in the header.
trait InC {
    fn name() -> String;
}

macro_rules! in_c {
    ($($rust:ty => $c:literal),*) => { $(impl InC for $rust { fn name() -> String { $c.to_owned() } })* };
}

in_c!(
    u32 => "uint32_t", usize => "size_t", f64 => "double", Code => "int32_t", *const u8 => "const uint8_t *",
    *mut Onboard => "poinsot_onboard *", *const Sample => "const poinsot_onboard_sample *", *mut Answer => "poinsot_onboard_answer *"
);

macro_rules! function_in_c {
    ($($argument:ident)*; $($qualifier:ident)?) => {
        impl<R: InC, $($argument: InC),*> InC for $($qualifier)? extern "C" fn($($argument),*) -> R {
            fn name() -> String {
                let arguments: &[String] = &[$($argument::name()),*];
                let arguments = if arguments.is_empty() { "void".to_owned() } else { arguments.join(", ") };
                format!("{} (*)({arguments})", R::name())
            }
        }
    };
}

function_in_c!(;);
function_in_c!(A; unsafe);
function_in_c!(A B; unsafe);
function_in_c!(A B C; unsafe);
function_in_c!(A B C D; unsafe);

fn type_of<F: InC>(_: F) -> String {
    F::name()
}

/// Name and type in C of every function.
fn functions() -> [(&'static str, String); 6] {
    type Init = unsafe extern "C" fn(*mut Onboard, usize, *const u8, usize) -> Code;
    type Push = unsafe extern "C" fn(*mut Onboard, *const Sample) -> Code;
    type Read = unsafe extern "C" fn(*mut Onboard, f64, *mut Answer) -> Code;
    [
        (
            "version",
            type_of(poinsot_onboard_version as extern "C" fn() -> u32),
        ),
        (
            "size",
            type_of(poinsot_onboard_size as extern "C" fn() -> usize),
        ),
        ("init", type_of(poinsot_onboard_init as Init)),
        ("push", type_of(poinsot_onboard_push as Push)),
        (
            "flush",
            type_of(poinsot_onboard_flush as unsafe extern "C" fn(*mut Onboard) -> Code),
        ),
        ("read", type_of(poinsot_onboard_read as Read)),
    ]
}

/// Name and number of every constant but the sizes.
fn constants() -> Vec<(&'static str, i64)> {
    use poinsot_onboard::Health;
    let codes = [
        ("OK", Code::Ok),
        ("NOT_FINITE", Code::NotFinite),
        ("QUATERNION", Code::Quaternion),
        ("DUPLICATE", Code::Duplicate),
        ("LATE", Code::Late),
        ("CLOCK_JUMP", Code::ClockJump),
        ("NULL", Code::Null),
        ("MEMORY", Code::Memory),
        ("NOT_INITIALISED", Code::NotInitialised),
        ("TABLE_LENGTH", Code::TableLength),
        ("TABLE_MAGIC", Code::TableMagic),
        ("TABLE_VERSION", Code::TableVersion),
        ("TABLE_CHECKSUM", Code::TableChecksum),
        ("CAPACITY", Code::Capacity),
        ("TABLE_NOT_FINITE", Code::TableNotFinite),
        ("COUNT", Code::Count),
        ("NOISE", Code::Noise),
        ("AXIS", Code::Axis),
        ("PRIOR", Code::Prior),
        ("UNPHYSICAL", Code::Unphysical),
        ("NEEDS_POSITION", Code::NeedsPosition),
        ("MODE", Code::Mode),
    ];
    let mut all: Vec<_> = codes
        .into_iter()
        .map(|(name, code)| (name, code as i64))
        .collect();
    all.extend([
        ("CONVERGING", Health::Converging as i64),
        ("DETERMINED", Health::Determined as i64),
        ("INCONSISTENT", Health::Inconsistent as i64),
        ("STALE", Health::Stale as i64),
        ("GYRO", MEASURED_GYRO.into()),
        ("ATTITUDE", MEASURED_ATTITUDE.into()),
        ("POSITION", MEASURED_POSITION.into()),
        ("VERSION", VERSION.into()),
        ("TABLE", poinsot_onboard::TABLE as i64),
        ("WHEELS", poinsot_onboard::WHEELS as i64),
        ("JOINTS", poinsot_onboard::JOINTS as i64),
        ("WINDOW", WINDOW as i64),
        ("SIZE", SIZE as i64),
    ]);
    all
}

macro_rules! offsets {
    ($c:literal, $rust:ty: $($field:ident)*) => { [$((concat!($c, ", ", stringify!($field)), offset_of!($rust, $field))),*] };
}

/// A C program whose assertions hold the header against this crate.
fn program() -> String {
    let mut out = String::from("#include \"poinsot_onboard.h\"\n");
    let mut holds = |condition: String| {
        writeln!(out, "_Static_assert({condition}, \"\");").unwrap();
    };
    for (name, number) in constants() {
        holds(format!("POINSOT_ONBOARD_{name} == {number}"));
    }
    holds("sizeof(poinsot_onboard) == POINSOT_ONBOARD_SIZE".to_owned());
    holds(format!(
        "_Alignof(poinsot_onboard) == {}",
        align_of::<Onboard>()
    ));
    holds(format!(
        "sizeof(poinsot_onboard_sample) == {}",
        size_of::<Sample>()
    ));
    holds(format!(
        "sizeof(poinsot_onboard_answer) == {}",
        size_of::<Answer>()
    ));
    let sample = offsets!("poinsot_onboard_sample", Sample: time_s gyro attitude position wheel_speed joint_position joint_rate force_B torque_B measured reserved);
    let answer = offsets!("poinsot_onboard_answer", Answer: value sigma covariance accepted gated health determined unknowns reserved);
    for (field, offset) in sample.into_iter().chain(answer) {
        holds(format!("offsetof({field}) == {offset}"));
    }
    for (name, of) in functions() {
        holds(format!(
            "_Generic(&poinsot_onboard_{name}, {of}: 1, default: 0)"
        ));
    }
    out
}

fn compiles(program: &str) -> bool {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("header.c");
    std::fs::write(&path, program).unwrap();
    let include = concat!(env!("CARGO_MANIFEST_DIR"), "/include");
    let mut compiler = Command::new(std::env::var("CC").unwrap_or("cc".to_owned()));
    let compiler = compiler.args([
        "-std=c11",
        "-Wall",
        "-Werror",
        "-fsyntax-only",
        "-I",
        include,
    ]);
    let done = compiler.arg(&path).output().unwrap();
    print!("{}", String::from_utf8_lossy(&done.stderr));
    done.status.success()
}

#[test]
fn xval_the_header_is_what_the_library_has() {
    let program = program();
    assert!(compiles(&program));
    // Planted: another offset, another number, another type.
    for (from, to) in [
        ("force_B) == ", "force_B) == 1"),
        ("AXIS == ", "AXIS == 1"),
        ("double, ", "float, "),
    ] {
        assert!(
            program.contains(from) && !compiles(&program.replace(from, to)),
            "{from}"
        );
    }
}

/// Every name of the header is compared above.
#[test]
fn unit_no_name_of_the_header_is_left_out() {
    let header = include_str!("../../include/poinsot_onboard.h");
    let declared =
        |line: &&str| line.trim_start().starts_with("POINSOT_ONBOARD_") && line.contains(" = ");
    let defined = header
        .lines()
        .filter(|l| l.starts_with("#define POINSOT_ONBOARD_") && !l.ends_with("_H"));
    assert_eq!(
        header.lines().filter(declared).count() + defined.count(),
        constants().len()
    );
    let prototypes = header
        .lines()
        .filter(|l| l.contains(" poinsot_onboard_") && l.ends_with(");"));
    assert_eq!(prototypes.count(), functions().len());
}
