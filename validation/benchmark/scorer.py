#!/usr/bin/env python3
"""Scores an entry, a CSV of numbers with sigmas, against the sealed truth. Needs Python alone.

    scorer.py ENTRY.csv [ENTRY.csv ...] [--vehicles]

Columns of an entry: vehicle,seed,number,value,sigma. An empty value and sigma refuse the number. An entry has every number of each
record it contains, and may leave out vehicles that it is not made for. README.md has the definitions."""

import argparse
import csv
import hashlib
import math
import pathlib
import statistics
import sys

HERE = pathlib.Path(__file__).resolve().parent
HEADER = ["vehicle", "seed", "number", "value", "sigma"]
SEEDS = 20
# |value - truth| / sigma above which the logarithmic score grows no more.
LIMIT = 10.0


class Malformed(ValueError):
    """What is wrong with an entry, and in which line."""


class Fact:
    """The sealed truth of a number."""

    def __init__(self, row):
        self.truth, self.nominal, self.prior, self.scale, self.bound = (
            float(row[key]) for key in ("truth", "nominal", "prior", "scale", "bound")
        )
        self.full, self.state = row["bound_kind"] == "full", row["state"]


class Line:
    """A line of an entry; `value` and `sigma` are None where the number is refused."""

    def __init__(self, vehicle, seed, number, value, sigma):
        self.vehicle, self.seed, self.number, self.value, self.sigma = vehicle, seed, number, value, sigma


def sealed_truth(folder=HERE):
    """Vehicle to number to `Fact`; refuses a file that does not have the recorded SHA-256."""
    content = (folder / "truth.csv").read_bytes()
    if hashlib.sha256(content).hexdigest() != (folder / "truth.sha256").read_text().strip():
        raise Malformed("truth.csv: its SHA-256 is not that of truth.sha256; restore both files")
    facts = {}
    for row in csv.DictReader(content.decode().splitlines()):
        facts.setdefault(row["vehicle"], {})[row["number"]] = Fact(row)
    return facts


def number_of(text, column, place):
    try:
        value = float(text)
    except ValueError:
        raise Malformed(f"{place}: {column} {text!r} is not a number") from None
    if not math.isfinite(value):
        raise Malformed(f"{place}: {column} is {text}; leave value and sigma empty to refuse a number")
    return value


def line_of(row, place, facts):
    if len(row) != len(HEADER):
        raise Malformed(f"{place}: {len(row)} cells, {len(HEADER)} expected")
    vehicle, seed, number, value, sigma = row
    if vehicle not in facts:
        raise Malformed(f"{place}: no vehicle {vehicle!r}")
    if number not in facts[vehicle]:
        raise Malformed(f"{place}: vehicle {vehicle} has no number {number!r}; numbers.csv lists them")
    if not seed.isascii() or not seed.isdigit() or int(seed) >= SEEDS or seed != str(int(seed)):
        raise Malformed(f"{place}: seed {seed!r} is not a whole number from 0 to {SEEDS - 1}")
    if (value == "") != (sigma == ""):
        raise Malformed(f"{place}: value and sigma are given together, or both empty")
    if value == "":
        return Line(vehicle, int(seed), number, None, None)
    line = Line(vehicle, int(seed), number, number_of(value, "value", place), number_of(sigma, "sigma", place))
    if line.sigma <= 0:
        raise Malformed(f"{place}: sigma {sigma} is not positive")
    return line


def read_entry(path, facts):
    """Lines of a well-formed entry; raises `Malformed` with the first fault."""
    try:
        rows = list(csv.reader(pathlib.Path(path).read_text(encoding="utf-8").splitlines(), strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise Malformed(f"{path}: cannot be read as CSV in UTF-8: {error}") from None
    if not rows or rows[0] != HEADER:
        raise Malformed(f"{path}:1: the header is not {','.join(HEADER)}")
    lines = {}
    for k, row in enumerate(rows[1:], start=2):
        line = line_of(row, f"{path}:{k}", facts)
        key = (line.vehicle, line.seed, line.number)
        if key in lines:
            raise Malformed(f"{path}:{k}: {line.number} of {line.vehicle}, seed {line.seed}, is given twice")
        lines[key] = line
    if not lines:
        raise Malformed(f"{path}: no line below the header")
    for vehicle, seed in dict.fromkeys((v, s) for v, s, _ in lines):
        for number in facts[vehicle]:
            if (vehicle, seed, number) not in lines:
                raise Malformed(f"{path}: {number} of {vehicle}, seed {seed}, is missing; an empty value refuses it")
    return list(lines.values())


class Score:
    """Of the lines of an entry, or of one vehicle.

    `log`: mean logarithmic score above that of an ideal answer, over numbers that data determine; `ratio`: root mean square of
    error over bound (full bounds alone); `wide`: median of sigma over bound; `coverage`: share of 95 % intervals with the truth;
    `false`, `missed`: refused though it must be answered, answered though nothing can know it; each with the count it is of."""

    def __init__(self, lines, facts):
        logs, errors, widths, inside = [], [], [], []
        self.records = len({(l.vehicle, l.seed) for l in lines})
        self.false = self.asked = self.missed = self.unknowable = self.answered = 0
        for line in lines:
            fact = facts[line.vehicle][line.number]
            # A sigma of the natural unit or more is a refusal in other words.
            told = line.value is not None and line.sigma < fact.scale
            self.answered += told
            if fact.state == "unknowable":
                self.unknowable += 1
                self.missed += told
                continue
            self.asked += fact.state == "asked"
            self.false += fact.state == "asked" and not told
            logs.append(log_score(line, fact, told))
            if not told:
                continue
            off = line.value - fact.truth
            inside.append(abs(off) <= 1.96 * line.sigma)
            if fact.full and fact.state == "asked":
                errors.append(off / fact.bound)
                widths.append(line.sigma / fact.bound)
        mean = lambda x: statistics.fmean(x) if x else math.nan
        self.log, self.coverage = mean(logs), mean(inside)
        self.ratio = math.sqrt(mean([e * e for e in errors])) if errors else math.nan
        self.typical = statistics.median(map(abs, errors)) / 0.6745 if errors else math.nan
        self.wide = statistics.median(widths) if widths else math.nan


def log_score(line, fact, told):
    """Negative logarithm of the stated density at the truth, over that of a normal with the bound as sigma at its own centre, less the
    half that an ideal answer loses on average: 0 for an ideal answer. A refusal states the nominal value and its prior."""
    value, sigma = (line.value, line.sigma) if told else (fact.nominal, fact.prior)
    z = min(abs(value - fact.truth) / sigma, LIMIT)
    return math.log(sigma / fact.bound) + z * z / 2 - 0.5


def cell(value, form):
    return "-" if isinstance(value, float) and math.isnan(value) else form.format(value)


HEAD = (
    "| entry | records | answered | log score | error / bound, rms | typical | sigma / bound | within 95 % | false refusals | missed |\n"
    "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"
)


def row(name, score, numbers):
    cells = [
        name,
        str(score.records),
        f"{100 * score.answered / numbers:.0f} %",
        cell(score.log, "{:+.2f}"),
        cell(score.ratio, "{:.3g}"),
        cell(score.typical, "{:.3g}"),
        cell(score.wide, "{:.3g}"),
        cell(100 * score.coverage, "{:.1f} %"),
        f"{score.false} of {score.asked}",
        f"{score.missed} of {score.unknowable}",
    ]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("entries", nargs="+")
    parser.add_argument("--vehicles", action="store_true", help="a line for each vehicle")
    given = parser.parse_args()
    try:
        facts = sealed_truth()
        entries = {path: read_entry(path, facts) for path in given.entries}
    except Malformed as fault:
        sys.exit(f"{fault}")
    print(HEAD)
    for path, lines in entries.items():
        name = pathlib.Path(path).stem
        print(row(name, Score(lines, facts), len(lines)))
        for vehicle in dict.fromkeys(l.vehicle for l in lines) if given.vehicles else ():
            own = [l for l in lines if l.vehicle == vehicle]
            print(row(f"{name}: {vehicle}", Score(own, facts), len(own)))


if __name__ == "__main__":
    main()
