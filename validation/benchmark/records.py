"""Writes the records of a vehicle, and the sealed truth of all.

    records.py [--seeds N] [--only WORD] [--out FOLDER]      records: FOLDER/VEHICLE/SEED/{model.toml, *.csv}, FOLDER/VEHICLE/numbers.csv
    records.py --seal                                        truth.csv anew, and its SHA-256 in truth.sha256"""

import argparse
import csv
import hashlib
import pathlib
import tomllib

import numpy as np

import bound
import vehicles

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
RECORDS = ROOT / "target/benchmark/records"
TRUTH, SEAL = HERE / "truth.csv", HERE / "truth.sha256"
# Nominal numbers are drawn about the truth: mass by this share, centre by this length in m, tensor by this share of sqrt(I_ii I_jj).
PRIOR_MASS, PRIOR_CENTRE_M, PRIOR_INERTIA = 0.10, 0.03, 0.10
# In natural units, the half-width of a 95 % interval within which a number must be answered; `bound` is infinite from one unit on.
ANSWER_WITHIN = 0.25
COLUMNS = ["vehicle", "number", "truth", "nominal", "prior", "scale", "bound", "bound_kind", "state"]


def write(name, seeds, out):
    """Records of a vehicle; those that are there are the same and stay."""
    missing = [s for s in seeds if not (out / name / str(s) / "done").exists()]
    if missing:
        save(vehicles.build(name, missing), out)


def save(family, out):
    for k, seed in enumerate(family.seeds):
        at = out / family.name / str(seed)
        at.mkdir(parents=True, exist_ok=True)
        (at / "model.toml").write_text(family.model[k])
        for file, times_s, names, values in family.tables[k]:
            rows = np.column_stack([times_s, values])
            np.savetxt(at / f"{file}.csv", rows, fmt="%.12g", delimiter=",", header=",".join(["time_s", *names]), comments="")
        (at / "done").touch()
    rows = [(n, f"{x:.10g}", f"{p:.10g}") for n, x, p in zip(family.numbers(), nominal(family), priors(family))]
    with open(out / family.name / "numbers.csv", "w", newline="") as file:
        csv.writer(file).writerows([("number", "nominal", "prior"), *rows])


def nominal(family):
    """Of the model file, which entrants read."""
    model = tomllib.loads(family.model[0])
    out = []
    for b, groups in family.unknown.items():
        body = next(x for x in model["body"] if x["name"] == f"b{b}")
        elements = [body["inertia_kg_m2"][e] for e in vehicles.families.ELEMENTS]
        out += [body["mass_kg"], *body["com_m"], *elements] if groups == "true" else elements
    return np.array(out)


def priors(family):
    """One sigma of nominal minus truth, by the rule that entrants are told."""
    model = tomllib.loads(family.model[0])
    out = []
    for b, groups in family.unknown.items():
        body = next(x for x in model["body"] if x["name"] == f"b{b}")
        moments = [body["inertia_kg_m2"][e] for e in ("xx", "yy", "zz")]
        elements = [PRIOR_INERTIA * np.sqrt(moments[i] * moments[j]) for i, j in vehicles.families.ELEMENTS.values()]
        out += [PRIOR_MASS * body["mass_kg"], *[PRIOR_CENTRE_M] * 3, *elements] if groups == "true" else elements
    return np.array(out)


def truth_rows(family):
    """Lines of truth.csv of a vehicle."""
    model = tomllib.loads(family.model[0])
    files = {file: times for file, times, _, _ in family.tables[0]}
    rows_of = {kind: files[file] for kind, file in vehicles.FILES.items() if file in files}
    least, scale = bound.bound(family, model, rows_of), bound.scales(family)
    kind = "rigid" if family.flight.rigid_only else "full"
    for n, x, given, prior, unit, sigma in zip(family.numbers(), family.true_values(), nominal(family), priors(family), scale, least):
        state = "unknowable" if np.isinf(sigma) else "asked" if 1.96 * sigma <= ANSWER_WITHIN * unit else "weak"
        yield [family.name, n, *(f"{v:.9g}" for v in (x, given, prior, unit)), f"{sigma:.4g}", kind, state]


def seal(out):
    """Truth of all vehicles, bounds to four digits. Goes on where it stopped: lines of a vehicle stay in its folder of records."""
    text = ",".join(COLUMNS) + "\n"
    for name in vehicles.VEHICLES:
        part = out / name / "truth_lines.csv"
        if not part.exists():
            print(f"truth of {name}", flush=True)
            lines = [",".join(row) + "\n" for row in truth_rows(vehicles.build(name, [0]))]
            part.parent.mkdir(parents=True, exist_ok=True)
            part.write_text("".join(lines))
        text += part.read_text()
    TRUTH.write_text(text)
    SEAL.write_text(hashlib.sha256(TRUTH.read_bytes()).hexdigest() + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--only", default="")
    parser.add_argument("--out", type=pathlib.Path, default=RECORDS)
    parser.add_argument("--seal", action="store_true")
    given = parser.parse_args()
    if given.seal:
        return seal(given.out)
    for name in (n for n in vehicles.VEHICLES if given.only in n):
        print(f"records of {name}", flush=True)
        write(name, range(given.seeds), given.out)


if __name__ == "__main__":
    main()
