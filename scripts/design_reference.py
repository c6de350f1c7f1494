#!/usr/bin/env python3
"""The best manoeuvre that other optimisers find for a case with [design]: figures of docs/validation/design.md.

    python3 scripts/design_reference.py CASE.toml --poinsot target/release/poinsot --method slsqp|cma|random \
        --evaluations 4000 --seed 1

The same free numbers, limits, wants and objective as `poinsot design`; joints as Fourier series alone. Every evaluation is
one `poinsot predict --json` of a case file written here. Needs NumPy, SciPy and cma (PyPI).
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import tomllib
from concurrent.futures import ThreadPoolExecutor

import numpy as np

POINTS = 64  # for each harmonic; the limit is shrunk by cos(pi / 64), so it holds between the points


class Case:
    def __init__(self, path, program):
        self.text = open(path).read()
        self.case = tomllib.loads(self.text)
        self.folder = os.path.dirname(os.path.abspath(path))
        self.program = program
        model = os.path.join(self.folder, self.case["model"])
        self.joints = [j["name"] for j in tomllib.load(open(model, "rb"))["joint"]]
        move = self.case["design"]["joint"][0]
        self.harmonics, self.base = move["harmonics"], move["base_frequency_hz"]
        self.evaluations = 0
        limit = {name: l for l in self.case["limits"]["joint"] for name in l["joints"]}
        self.limits = [limit[name] for name in self.joints]
        omega = 2.0 * math.pi * self.base * np.arange(1, self.harmonics + 1)
        n = POINTS * self.harmonics
        t = np.arange(n) / (n * self.base)
        s, c = np.sin(np.outer(t, omega)), np.cos(np.outer(t, omega))
        value, rate = np.hstack([s, c]), np.hstack([c * omega, -s * omega])
        shrink = math.cos(math.pi / POINTS)
        self.units, self.rows = [], []
        for l in self.limits:
            room = l["position_rad"][1]
            unit = np.tile(np.minimum(room, l["rate_rad_s"] / omega), 2)
            self.units.append(unit)
            self.rows.append(np.vstack([value * unit / room, rate * unit / l["rate_rad_s"]]) / shrink)
        self.size = 2 * self.harmonics * len(self.joints)

    def split(self, x):
        return np.reshape(x, (len(self.joints), -1))

    def largest(self, x):
        """Share of the limits that each joint uses."""
        return [np.abs(rows @ own).max() for rows, own in zip(self.rows, self.split(x))]

    def inside(self, x):
        share = np.maximum(self.largest(x), 1.0)
        return (self.split(x) / share[:, None]).ravel()

    def ratios(self, x):
        """Logarithm of sigma over wanted sigma of everything wanted."""
        self.evaluations += 1
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "case.toml")
            with open(path, "w") as out:
                out.write('schema = "poinsot.case/1"\n')
                out.write(f'model = "{os.path.join(self.folder, self.case["model"])}"\n')
                out.write(f"duration_s = {float(self.case['duration_s'])!r}\n[initial]\n")
                for key, value in self.case["initial"].items():
                    out.write(f"{key} = {value}\n")
                for name, own, unit in zip(self.joints, self.split(x), self.units):
                    a, b = np.split(own * unit, 2)
                    out.write(f'[[joint_motion]]\njoint = "{name}"\ninterpolation = "fourier"\n')
                    out.write(f"base_frequency_hz = {self.base!r}\n")
                    out.write(f"sine_rad = {[float(v) for v in a]}\ncosine_rad = {[float(v) for v in b]}\n")
                out.write(f"[output]\nrate_hz = {self.case['output']['rate_hz']}\n")
                for want in self.case["want"]:
                    out.write(f'[[want]]\nnumber = "{want["number"]}"\nsigma = {want["sigma"]!r}\n')
            run = subprocess.run([self.program, "predict", path, "--json"], capture_output=True, check=False)
        wants = json.loads(run.stdout)["wants"]
        log = [math.log(w["sigma"] / w["wanted_sigma"]) if w["sigma"] else 10.0 for w in wants]
        return np.array(log)


def random_best(case, count, seed):
    rng = np.random.default_rng(seed)
    best, at = np.inf, None
    for _ in range(count):
        x = rng.normal(size=case.size)
        x = (case.split(x) / np.array(case.largest(x))[:, None]).ravel()
        worst = case.ratios(x).max()
        if worst < best:
            best, at = worst, x
    return best, at


def cma_best(case, count, seed):
    import cma

    rng = np.random.default_rng(seed)
    start = case.inside(rng.normal(size=case.size) * 0.3)
    options = {"seed": seed + 1, "maxfevals": count, "verbose": -9}
    search = cma.CMAEvolutionStrategy(start, 0.2, options)
    search.optimize(lambda x: case.ratios(case.inside(x)).max())
    return search.result.fbest, case.inside(search.result.xbest)


def slsqp_best(case, count, seed):
    from scipy.optimize import minimize

    _, start = random_best(case, min(100, count // 4), seed)
    known = {}
    step = 1.0e-5

    def ratios(x):
        key = x.tobytes()
        if key not in known:
            known.clear()
            known[key] = case.ratios(x)
        return known[key]

    def slopes(x):
        here = ratios(x)
        points = [x + step * np.eye(case.size)[j] for j in range(case.size)]
        with ThreadPoolExecutor(2) as pool:
            there = list(pool.map(case.ratios, points))
        return np.array([(t - here) / step for t in there]).T

    rows = np.zeros((0, case.size + 1))
    width = 2 * case.harmonics
    for j, own in enumerate(case.rows):
        block = np.zeros((len(own), case.size + 1))
        block[:, width * j : width * (j + 1)] = own
        rows = np.vstack([rows, block])
    rows = rows[::4]  # SLSQP is slow with more; the end is scaled into the limits
    limits = {
        "type": "ineq",
        "fun": lambda z: np.hstack([1.0 - rows @ z, 1.0 + rows @ z]),
        "jac": lambda z: np.vstack([-rows, rows]),
    }
    largest = {
        "type": "ineq",
        "fun": lambda z: z[-1] - ratios(z[:-1]),
        "jac": lambda z: np.hstack([-slopes(z[:-1]), np.ones((len(ratios(z[:-1])), 1))]),
    }
    start = np.append(0.98 * start, ratios(0.98 * start).max())
    best = [np.inf, None]

    class Spent(Exception):
        pass

    def watch(z):
        x = case.inside(z[:-1])
        worst = case.ratios(x).max()
        if worst < best[0]:
            best[:] = [worst, x]
        if case.evaluations > count:
            raise Spent

    try:
        minimize(
            lambda z: z[-1],
            start,
            jac=lambda z: np.eye(case.size + 1)[-1],
            constraints=[limits, largest],
            method="SLSQP",
            callback=watch,
            options={"maxiter": 200, "ftol": 1.0e-5},
        )
    except Spent:
        pass
    return tuple(best)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case")
    parser.add_argument("--poinsot", default="target/release/poinsot")
    parser.add_argument("--method", choices=["slsqp", "cma", "random"], default="slsqp")
    parser.add_argument("--evaluations", type=int, default=4000)
    parser.add_argument("--seed", type=int, default=1)
    words = parser.parse_args()
    case = Case(words.case, words.poinsot)
    find = {"slsqp": slsqp_best, "cma": cma_best, "random": random_best}[words.method]
    best, _ = find(case, words.evaluations, words.seed)
    print(f"{words.method} seed {words.seed}: worst ratio {math.exp(best):.4f} after {case.evaluations} evaluations")


if __name__ == "__main__":
    main()
