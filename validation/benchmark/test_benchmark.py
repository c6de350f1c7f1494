"""The scorer refuses malformed entries and scores as its page says; the bound is that of plain least squares; the truth is what the
vehicles have. In seconds, by NumPy and pytest alone."""

import hashlib
import math
import pathlib
import random
import sys

import numpy as np
import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import scorer
import vehicles  # first: it names the folder of the simulator
import bound
import records

FACTS = scorer.sealed_truth()
VEHICLE = "one_axis"


def lines(value=lambda fact: (fact.truth, fact.bound), vehicle=VEHICLE, seed=0):
    """Cells of an entry of one record."""
    cells = lambda name, fact: [vehicle, str(seed), name, *(str(x) for x in value(fact))]
    return [cells(name, fact) for name, fact in FACTS[vehicle].items()]


def known(fact):
    return (fact.truth, fact.bound) if math.isfinite(fact.bound) else ("", "")


def written(folder, rows, header=scorer.HEADER):
    path = folder / "entry.csv"
    path.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n")
    return path


def changed(column, text, row=0):
    rows = lines(known)
    rows[row][column] = text
    return rows


MALFORMED = {
    "no line": ([], "no line below"),
    "a cell too few": ([["one_axis", "0", "b0.mass_kg", "1"]], "4 cells, 5 expected"),
    "a cell too many": ([[*lines(known)[0], "1"]], "6 cells, 5 expected"),
    "unknown vehicle": (changed(0, "shuttle"), "no vehicle 'shuttle'"),
    "unknown number": (changed(2, "b0.mass_kg"), "has no number 'b0.mass_kg'"),
    "seed of another benchmark": (changed(1, "20"), "seed '20'"),
    "negative seed": (changed(1, "-1"), "seed '-1'"),
    "seed with zeros": (changed(1, "00"), "seed '00'"),
    "value in words": (changed(3, "about 5", 2), "value 'about 5' is not a number"),
    "value not finite": (changed(3, "nan", 2), "value is nan"),
    "sigma infinite": (changed(4, "inf", 2), "sigma is inf"),
    "sigma of zero": (changed(4, "0", 2), "sigma 0 is not positive"),
    "negative sigma": (changed(4, "-0.1", 2), "sigma -0.1 is not positive"),
    "value without sigma": (changed(4, "", 2), "together, or both empty"),
    "sigma without value": (changed(3, "", 2), "together, or both empty"),
    "a number missing": (lines(known)[1:], "is missing"),
    "a number twice": (lines(known) + lines(known)[:1], "given twice"),
}


@pytest.mark.parametrize("case", MALFORMED)
def test_prop_a_malformed_entry_is_refused(case, tmp_path):
    rows, says = MALFORMED[case]
    with pytest.raises(scorer.Malformed, match="entry.csv") as fault:
        scorer.read_entry(written(tmp_path, rows), FACTS)
    assert says in str(fault.value)


def test_prop_other_headers_bytes_and_files_are_refused(tmp_path):
    for content in (b"", b"vehicle,seed,number,value\n", b"\xff\xfe", b'vehicle,seed,number,value,sigma\none_axis,0,"b0'):
        path = tmp_path / "entry.csv"
        path.write_bytes(content)
        with pytest.raises(scorer.Malformed):
            scorer.read_entry(path, FACTS)
    with pytest.raises(scorer.Malformed):
        scorer.read_entry(tmp_path / "missing.csv", FACTS)


def test_prop_a_changed_truth_is_refused(tmp_path):
    (tmp_path / "truth.csv").write_bytes(scorer.HERE.joinpath("truth.csv").read_bytes() + b"\n")
    (tmp_path / "truth.sha256").write_bytes(scorer.HERE.joinpath("truth.sha256").read_bytes())
    with pytest.raises(scorer.Malformed, match="SHA-256"):
        scorer.sealed_truth(tmp_path)


def scored(folder, value, seeds=20):
    rows = [row for seed in range(seeds) for row in lines(value, seed=seed)]
    return scorer.Score(scorer.read_entry(written(folder, rows), FACTS), FACTS)


def test_stat_an_ideal_entry_scores_zero_and_others_more(tmp_path):
    draw = random.Random(1)
    drawn = lambda sigma: lambda f: (f.truth + f.bound * draw.gauss(0, 1), sigma * f.bound) if math.isfinite(f.bound) else ("", "")
    ideal, bold, timid = (scored(tmp_path, drawn(sigma)) for sigma in (1.0, 0.2, 5.0))
    # 60 numbers: one sigma of the mean of z^2 / 2 is 0.09.
    assert abs(ideal.log) < 0.3 and abs(ideal.ratio - 1) < 0.3 and ideal.coverage > 0.85 and ideal.wide == 1.0
    assert bold.log > ideal.log + 1 and bold.coverage < 0.6
    assert timid.log > ideal.log + 0.5 and timid.coverage == 1.0
    assert ideal.false == ideal.missed == 0 and ideal.asked == ideal.unknowable == 60


def test_exact_refusals_are_counted_on_both_sides(tmp_path):
    refused = scored(tmp_path, lambda f: ("", ""), seeds=1)
    assert (refused.false, refused.asked, refused.missed, refused.unknowable) == (3, 3, 0, 3)
    every = scored(tmp_path, lambda f: (f.truth, 1e-3 * f.scale), seeds=1)
    assert (every.false, every.missed) == (0, 3)
    # A sigma as large as the number itself is a refusal in other words.
    vague = scored(tmp_path, lambda f: (f.truth, 2 * f.scale), seeds=1)
    assert (vague.false, vague.missed, vague.log) == (3, 0, refused.log)


def test_exact_without_input_noise_the_bound_is_that_of_least_squares():
    family = vehicles.Benchmark("check", [0])
    body = vehicles.families.bus(family.draw)
    family.bodies([body], {0: '["inertia"]'})
    none = np.zeros((1, 0))
    push = lambda t: (np.array([[3.0 * (t < 4), 2.0 * (2 < t < 6), -4.0 * (t > 5)]]), np.zeros((1, 3)))
    start = vehicles.families.start(family.draw, 0.05)
    family.fly(vehicles.motion.Vehicle([body]), lambda t: (none, none, none), start, np.arange(101) / 10, 0.05, wrench=push)
    model = {"sensor": [{"type": "gyro", "noise_rad_s": 1e-4}, {"type": "attitude", "noise_rad": 2e-4}]}
    found = bound.information(family, model, {"gyro": family.flight.times_s, "attitude": family.flight.times_s[::5]})
    slopes = bound.sensitivities(family)
    rates, turns = slopes["rates"] / 1e-4, slopes["attitude"][::5] / 2e-4
    bias = np.tile(np.eye(3) / 1e-4, (len(rates), 1))
    rows = np.vstack([np.hstack([rates.reshape(-1, 18), bias]), np.hstack([turns.reshape(-1, 18), np.zeros((3 * len(turns), 3))])])
    normal = rows.T @ rows + np.diag([0.0] * 18 + [1.0] * 3)
    expected = normal[:18, :18] - normal[:18, 18:] @ np.linalg.solve(normal[18:, 18:], normal[18:, :18])
    assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max()


def test_regress_the_sealed_truth_is_that_of_the_vehicles():
    family = vehicles.build("target_1_joint", [0, 3])
    for name, value, nominal in zip(family.numbers(), family.true_values(), records.nominal(family)):
        fact = FACTS["target_1_joint"][name]
        assert math.isclose(fact.truth, value, rel_tol=1e-7) and math.isclose(fact.nominal, nominal, rel_tol=1e-7)
    # One vehicle and motion, noise of its own for each seed.
    assert family.model[0] == family.model[1]
    assert not np.array_equal(family.tables[0][0][3], family.tables[1][0][3])
    assert set(FACTS) == set(vehicles.VEHICLES)


def test_exact_the_seal_is_a_hash_of_the_file():
    assert hashlib.sha256(records.TRUTH.read_bytes()).hexdigest() == records.SEAL.read_text().strip()
