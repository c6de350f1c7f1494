#!/usr/bin/env python3
"""Builds the gallery: ten reports from shipped data, one of every kind, in target/gallery/NAME/report.html.

    scripts/gallery                     build the program, then every report
    scripts/gallery --poinsot PATH      use a program that is already built
    scripts/gallery NAME ...            only these
"""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "target/gallery"
STSAT3 = "data/stsat3/model.toml"
SIX_SLEWS = "data/stsat3/multiaxis/telemetry_noisy.csv"
ONE_SLEW = "data/stsat3/paper/telemetry_noisy.csv"
# A result that says "no" or "in part" is as good for a page as any.
ANSWERED = (0, 1)


def identify(model, *telemetry):
    return ["identify", "--model", model, *(word for file in telemetry for word in ("--telemetry", file)), "--out", "{out}"]


# Name: what it shows, commands. {out} is the folder of the report, {all} that of the gallery; a command whose first word ends in
# .json keeps what the rest prints; "edit" copies a file with one text replaced.
REPORTS = {
    "determined": ("All six inertia terms of a satellite from six slews", [identify(STSAT3, SIX_SLEWS)]),
    "partly_determined": ("The same satellite after one slew: three directions are open", [identify(STSAT3, ONE_SLEW)]),
    "contradicted": (
        "A wheel that turns the other way than the model says",
        [
            ["edit", STSAT3, "{out}/model.toml", "axis = [1.0, 0.0, 0.0]", "axis = [-1.0, 0.0, 0.0]"],
            identify("{out}/model.toml", SIX_SLEWS),
        ],
    ),
    "robot": (
        "A space robot of seven bodies: the base from one motion of its arm",
        [identify("data/ma2008/model_noisy.toml", "data/ma2008/traj1/telemetry_noisy.csv")],
    ),
    "seven_records": (
        "An arm with all its bodies unknown, seven records without noise",
        [identify("data/xu2017/model.toml", *(f"data/xu2017/C{k}/telemetry.parquet" for k in range(1, 8)))],
    ),
    "validation": (
        "An estimate predicts a record that it has not seen",
        [
            identify(STSAT3, SIX_SLEWS),
            ["validate", "--model", STSAT3, "--estimate", "{out}", "--against", ONE_SLEW, "--out", "{out}/against"],
        ],
    ),
    "prediction": (
        "What a manoeuvre will tell before it is flown",
        [["{out}/prediction.json", "predict", "data/cases/stsat3_kim2010.toml", "--json"]],
    ),
    "comparison": (
        "Two answers of one satellite from two manoeuvres",
        [
            identify(STSAT3, SIX_SLEWS),
            ["simulate", "data/cases/stsat3_three_slews.toml", "--out", "{out}/three"],
            [*identify(STSAT3, "{out}/three/telemetry.csv")[:-1], "{out}/three"],
            ["{out}/comparison.json", "compare", "{out}", "{out}/three", "--json"],
        ],
    ),
    "design": (
        "A manoeuvre that reaches the wanted accuracy within the limits of its wheels",
        [
            ["edit", "data/cases/stsat3_truth.toml", "{out}/stsat3_truth.toml", "", ""],
            ["edit", "data/cases/stsat3_design.toml", "{out}/design.toml", "seed = 1\n", "seed = 1\nevaluations = 300\n"],
            ["design", "{out}/design.toml", "--out", "{out}/made"],
        ],
    ),
    "campaign": (
        "Twenty repetitions of an experiment with new noise",
        [["campaign", "data/campaigns/stsat3_multiaxis.toml", "--trials", "20", "--out", "{out}/made"]],
    ),
}
# Where the result lies, where it is not the folder of the report.
RESULT = {
    "validation": "against",
    "comparison": "comparison.json",
    "prediction": "prediction.json",
    "design": "made",
    "campaign": "made",
}


def run(program, words, kept=None):
    done = subprocess.run([program, *words], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode not in ANSWERED:
        sys.exit(f"gallery: exit code {done.returncode}: poinsot {' '.join(words)}\n{done.stderr}")
    if kept:
        (ROOT / kept).write_text(done.stdout)


def build(program, name):
    """The report of one name; gives its path."""
    folder = OUT / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for words in REPORTS[name][1]:
        first, *rest = [word.replace("{out}", f"target/gallery/{name}") for word in words]
        if first == "edit":
            source, target, before, after = rest
            text = (ROOT / source).read_text()
            if before not in text:
                sys.exit(f"gallery: {source} has no {before!r}")
            (ROOT / target).write_text(text.replace(before, after, 1))
        elif first.endswith(".json"):
            run(program, rest, first)
        else:
            run(program, [first, *rest])
    result = folder / RESULT.get(name, "")
    run(program, ["report", str(result.relative_to(ROOT))])
    return (result if result.is_dir() else result.parent) / "report.html"


def gallery(program, names=None):
    """Paths of the reports by name."""
    program = str(Path(program).resolve())
    return {name: build(program, name) for name in names or REPORTS}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", default="target/release/poinsot", help="program to use; scripts/gallery builds the default")
    parser.add_argument("names", nargs="*", help="reports to build; default: all")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.names if name not in REPORTS]
    if unknown:
        sys.exit(f"gallery: no report '{unknown[0]}'; use one of: {', '.join(REPORTS)}")
    for name, path in gallery(arguments.poinsot, arguments.names).items():
        print(f"{path.relative_to(ROOT)}: {REPORTS[name][0]}")


if __name__ == "__main__":
    main()
