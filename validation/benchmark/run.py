#!/usr/bin/env python3
"""The benchmark's table by one command: records, baselines, scores.

    run.py [--seeds N] [--vehicles A,B] [--entries A,B] [--poinsot PROGRAM] [--sysid-python PYTHON] [--out FOLDER]

Goes on where it stopped: records stay, and so do the answers of an entry to a vehicle (FOLDER/answers/ENTRY/VEHICLE_SEED.csv; those of
Poinsot as long as the program is the same). Writes FOLDER/entries/ENTRY.csv, FOLDER/table.md with the date, and prints the table."""

import argparse
import csv
import datetime
import hashlib
import os
import pathlib
import subprocess
import sys

# Small matrices: threads only wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE / "baselines"))

import records
import scorer
import vehicles
from common import Answer, asked

ENTRIES = [
    "poinsot",
    "poinsot_linear",
    "kim2010_batch",
    "kim2010_suggested",
    "ma2008",
    "xu2017_linear",
    "kalman",
    "least_squares",
    "mujoco_sysid",
]


def answers_of(entry, folders, given):
    """Rows of the answers of an entry to the records of a vehicle."""
    import identify
    import kalman
    import least_squares
    import mujoco_sysid

    if entry in identify.METHODS:
        found = [a for f in folders for a in identify.estimate(given.poinsot, entry, f)]
    elif entry == "kalman":
        found = kalman.estimate_all(folders)
    elif entry == "least_squares":
        found = [a for f in folders for a in least_squares.estimate(f)]
    elif folders[0].parent.name in mujoco_sysid.VEHICLES:
        script = HERE / "baselines/mujoco_sysid.py"
        done = subprocess.run([given.sysid_python, script, *folders], capture_output=True, text=True, check=True)
        return list(csv.reader(done.stdout.splitlines()))
    else:
        found = [Answer(f.parent.name, int(f.name), n) for f in folders for n in asked(f)[0]]
    return [a.row() for a in found]


def answered(entry, folders, given, mark):
    """As `answers_of`; records answered before keep their answers. Poinsot's belong to a program: `mark`."""
    part = lambda f: given.out / "answers" / f"{entry}{mark}" / f"{f.parent.name}_{f.name}.csv"
    missing = [f for f in folders if not part(f).exists()]
    if missing:
        found = answers_of(entry, missing, given)
        part(missing[0]).parent.mkdir(parents=True, exist_ok=True)
        for folder in missing:
            new = part(folder).with_suffix(".new")
            with open(new, "w", newline="") as file:
                csv.writer(file).writerows(r for r in found if str(r[1]) == folder.name)
            new.rename(part(folder))
    rows = []
    for folder in folders:
        with open(part(folder), newline="") as file:
            rows += csv.reader(file)
    return rows


def write_entry(entry, rows, out):
    """The entry without vehicles of which it answers nothing: it is not made for them."""
    able = {r[0] for r in rows if r[3]}
    path = out / "entries" / f"{entry}.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([scorer.HEADER, *(r for r in rows if r[0] in able or entry == "poinsot")])
    return path


def table(paths, seeds):
    """Of all vehicles of each entry, then error over bound of each vehicle."""
    facts = scorer.sealed_truth()
    entries = {p.stem: scorer.read_entry(p, facts) for p in paths}
    yield f"{seeds} seeds, {datetime.date.today().isoformat()}\n"
    yield scorer.HEAD
    for name, lines in entries.items():
        yield scorer.row(name, scorer.Score(lines, facts), len(lines))
    yield "\n| vehicle | " + " | ".join(entries) + " |\n|---|" + "---:|" * len(entries)
    for vehicle in facts:
        cells = []
        for lines in entries.values():
            own = [l for l in lines if l.vehicle == vehicle]
            score = scorer.Score(own, facts)
            cells.append(scorer.cell(score.ratio, "{:.3g}") if own and score.answered else "-")
        yield f"| {vehicle} | " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=scorer.SEEDS)
    parser.add_argument("--vehicles", default=",".join(vehicles.VEHICLES))
    parser.add_argument("--entries", default=",".join(ENTRIES))
    parser.add_argument("--poinsot", default=str(ROOT / "target/release/poinsot"))
    parser.add_argument("--sysid-python", default=str(ROOT / "target/benchmark/sysid-venv/bin/python"))
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target/benchmark")
    given = parser.parse_args()
    given.poinsot, given.out = str(pathlib.Path(given.poinsot).resolve()), given.out.resolve()
    program = hashlib.sha256(pathlib.Path(given.poinsot).read_bytes()).hexdigest()[:12]
    rows = {entry: [] for entry in given.entries.split(",")}
    for name in given.vehicles.split(","):
        records.write(name, range(given.seeds), given.out / "records")
        folders = [given.out / "records" / name / str(s) for s in range(given.seeds)]
        for entry in rows:
            own = entry in ENTRIES[:6]
            print(f"{name}: {entry}", flush=True)
            rows[entry] += answered(entry, folders, given, f"_{program}" if own else "")
    paths = [write_entry(entry, found, given.out) for entry, found in rows.items() if any(r[3] for r in found)]
    text = "\n".join(table(paths, given.seeds)) + "\n"
    (given.out / "table.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
