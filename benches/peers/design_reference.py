#!/usr/bin/env python3
"""What other optimisers find for a case with [design]: figures of docs/validation/design.md.

    python3 benches/peers/design_reference.py [CASE.toml | --vehicle SEED] --poinsot target/release/poinsot --method slsqp cma random ipopt design \
        --seeds 1 2 3 --evaluations 5000 [--duration 60]

The same free numbers, limits, wants and objective (the largest ratio of sigma to wanted sigma) as `poinsot design`: joints as
Fourier series, wheels as clamped cubic splines. Linear limits hold between points; body rate and wheel torque are the largest
of the samples. Every evaluation is a case of its own, predicted by `poinsot predict`. Needs NumPy, SciPy, cma and CasADi.
"""

import argparse
import json
import math
import os
import subprocess
import tempfile
import time
import tomllib

import numpy as np

POINTS = 64  # for each harmonic; the limit is shrunk by cos(pi / 64), so it holds between the points
HULL = 2  # parts of a cubic piece whose Bezier points are bounded
STEP = 1.0e-5  # of differences, in units of the free numbers
BATCH = 64  # cases of one call
BOX = 1.3  # no free number within the limits is larger: 4 / pi for a coefficient of a bounded motion, 1 for a node
UNKNOWN = 10.0  # logarithm of the ratio of what a manoeuvre does not show


class Fourier:
    """One joint: sines, then cosines."""

    def __init__(self, name, limit, move, duration):
        self.name, harmonics = name, move["harmonics"]
        self.base = move.get("base_frequency_hz", 1.0 / duration)
        omega = 2.0 * math.pi * self.base * np.arange(1, harmonics + 1)
        n = POINTS * harmonics
        t = np.arange(n) / (n * self.base)
        s, c = np.sin(np.outer(t, omega)), np.cos(np.outer(t, omega))
        room = limit["position_rad"][1]
        self.unit = np.tile(np.minimum(room, limit["rate_rad_s"] / omega), 2)
        value, rate = np.hstack([s, c]), np.hstack([c * omega, -s * omega])
        rows = np.vstack([value / room, rate / limit["rate_rad_s"]])
        self.rows = rows * self.unit / math.cos(math.pi / POINTS)

    def text(self, x):
        a, b = np.split(x * self.unit, 2)
        return (
            f'[[joint_motion]]\njoint = "{self.name}"\ninterpolation = "fourier"\nbase_frequency_hz = {self.base!r}\n'
            f"sine_rad = {a.tolist()}\ncosine_rad = {b.tolist()}\n"
        )


class Spline:
    """One wheel: inner nodes of its speed, at rest at both ends."""

    def __init__(self, name, limit, nodes, duration):
        from scipy.interpolate import CubicSpline

        self.name, self.t = name, np.linspace(0.0, duration, nodes)
        self.unit = np.full(nodes - 2, limit["speed_rad_s"])
        ends = np.linspace(0.0, duration, HULL * (nodes - 1) + 1)
        h = ends[1]
        columns = []
        for j in range(nodes - 2):
            y = np.zeros(nodes)
            y[j + 1] = 1.0
            curve = CubicSpline(self.t, y, bc_type="clamped")
            value, rate = curve(ends), curve(ends, 1)
            columns.append(np.hstack([value, value[:-1] + h / 3 * rate[:-1], value[1:] - h / 3 * rate[1:]]))
        self.rows = np.array(columns).T

    def text(self, x):
        speed = [0.0, *(x * self.unit).tolist(), 0.0]
        return (
            f'[[wheel_motion]]\nwheel = "{self.name}"\ninterpolation = "cubic_clamped"\n'
            f"time_s = {self.t.tolist()}\nspeed_rad_s = {speed}\n"
        )


class Case:
    def __init__(self, path, program, duration):
        self.case = tomllib.load(open(path, "rb"))
        self.folder = os.path.dirname(os.path.abspath(path))
        self.path, self.program = path, program
        self.duration = duration or float(self.case["duration_s"])
        self.model = os.path.join(self.folder, self.case["model"])
        model = tomllib.load(open(self.model, "rb"))
        limits, design = self.case["limits"], self.case["design"]

        def of(kind, names):
            found = {}
            for table in limits.get(kind, []):
                found.update({name: table for name in table.get(kind + "s", names)})
            return found

        joints = [j["name"] for j in model.get("joint", []) if j.get("type") != "fixed"]
        wheels = [w["name"] for w in model.get("wheel", [])]
        joint_limits, wheel_limits = of("joint", joints), of("wheel", wheels)
        self.movers = []
        for move in design.get("joint", []):
            for name in move.get("joints", joints):
                self.movers.append(Fourier(name, joint_limits[name], move, self.duration))
        for move in design.get("wheel", []):
            for name in move.get("wheels", wheels):
                self.movers.append(Spline(name, wheel_limits[name], move["nodes"], self.duration))
        self.peaks = {f"torque of {w}": l["torque_N_m"] for w, l in wheel_limits.items() if "torque_N_m" in l}
        if "body_rate_rad_s" in limits:
            self.peaks["body rate"] = limits["body_rate_rad_s"]
        ends = np.cumsum([0] + [len(m.unit) for m in self.movers])
        self.parts = [slice(a, b) for a, b in zip(ends, ends[1:])]
        self.size, self.evaluations = int(ends[-1]), 0

    def largest(self, x):
        """Share of the linear limits that each mover uses."""
        return [np.abs(m.rows @ x[p]).max() for m, p in zip(self.movers, self.parts)]

    def inside(self, x, stretch=False):
        x = np.array(x, dtype=float)
        for share, part in zip(self.largest(x), self.parts):
            x[part] /= share if stretch else max(share, 1.0)
        return x

    def written(self, x):
        text = f'schema = "poinsot.case/2"\nmodel = "{self.model}"\nduration_s = {self.duration!r}\n[initial]\n'
        for key, value in self.case.get("initial", {}).items():
            text += f"{key} = {json.dumps(value)}\n"
        text += "".join(m.text(x[p]) for m, p in zip(self.movers, self.parts))
        text += f"[output]\nrate_hz = {self.case['output']['rate_hz']}\n"
        for want in self.case["want"]:
            text += "[[want]]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in want.items())
        return text

    def all_values(self, points):
        """Logarithms of sigma over wanted sigma, and by how much each peak exceeds its limit, for every point."""
        out = []
        for first in range(0, len(points), BATCH):
            out += self.batch(points[first : first + BATCH])
        return out

    def batch(self, points):
        self.evaluations += len(points)
        with tempfile.TemporaryDirectory() as folder:
            paths = [os.path.join(folder, f"case{k}.toml") for k in range(len(points))]
            for path, x in zip(paths, points):
                with open(path, "w") as out:
                    out.write(self.written(x))
            run = subprocess.run([self.program, "predict", *paths, "--json"], capture_output=True, check=False)
        if run.returncode > 1:
            raise RuntimeError(run.stderr.decode())
        found = json.loads(run.stdout)
        values = []
        for one in [found] if isinstance(found, dict) else found:
            logs = [math.log(w["sigma"] / w["wanted_sigma"]) if w["sigma"] else UNKNOWN for w in one["wants"]]
            peaks = {p["what"]: p["value"] for p in one["peaks"]}
            values.append((np.array(logs), np.array([peaks[k] / v - 1.0 for k, v in self.peaks.items()])))
        return values

    def values(self, x):
        return self.all_values([x])[0]

    def slopes(self, x):
        """Values at a point with one-sided differences of both kinds."""
        here, *beside = self.all_values([x, *(x + STEP * np.eye(self.size))])
        return here, [np.array([(b[k] - here[k]) / STEP for b in beside]).T for k in range(2)]

    def feasible(self, x):
        """The largest ratio of the part of the point that holds every limit, and its share."""
        x = self.inside(x)
        for share in (1.0, 0.998, 0.99, 0.97, 0.94, 0.9, 0.8, 0.6, 0.4):
            logs, peaks = self.values(share * x)
            if peaks.max(initial=-1.0) <= 1.0e-6:
                return logs.max(), share * x
        return np.inf, x


def random_best(case, count, seed):
    rng = np.random.default_rng(seed)
    points = [case.inside(rng.normal(size=case.size), stretch=True) for _ in range(count)]
    best, at = np.inf, points[0]
    for x, (logs, peaks) in zip(points, case.all_values(points)):
        # A peak grows at least as fast as the motion: the share that holds it is flown.
        share = 1.0 / max(1.0, 1.0 + peaks.max(initial=-1.0))
        worst = logs.max() if share == 1.0 else case.values(0.99 * share * x)[0].max()
        if worst < best:
            best, at = worst, 0.99 * share * x if share < 1.0 else x
    return at


def cma_best(case, count, seed):
    import cma

    start = case.inside(np.random.default_rng(seed).normal(size=case.size) * 0.3)
    search = cma.CMAEvolutionStrategy(start, 0.2, {"seed": seed + 1, "maxfevals": count, "verbose": -9})
    while not search.stop():
        asked = search.ask()
        found = case.all_values([case.inside(x) for x in asked])
        search.tell(asked, [logs.max() + 20.0 * max(0.0, peaks.max(initial=0.0)) for logs, peaks in found])
    return case.inside(search.result.xbest)


def linear_rows(case):
    rows = np.zeros((sum(len(m.rows) for m in case.movers), case.size))
    first = 0
    for m, part in zip(case.movers, case.parts):
        rows[first : first + len(m.rows), part] = m.rows
        first += len(m.rows)
    return rows


class Known:
    """Values and slopes of the last point; both are asked for one after the other."""

    def __init__(self, case, count):
        self.case, self.count, self.at, self.best = case, count, None, (np.inf, None)

    def __call__(self, x):
        x = np.array(x, dtype=float).ravel()
        if self.at is None or not np.array_equal(x, self.at):
            if self.case.evaluations + self.case.size >= self.count:
                raise StopIteration
            self.here, self.slope = self.case.slopes(x)
            self.at = x
            inside = max(self.case.largest(x)) <= 1.0 + 1.0e-9 and self.here[1].max(initial=-1.0) <= 1.0e-6
            if inside and self.here[0].max() < self.best[0]:
                self.best = (self.here[0].max(), x)
        return self.here, self.slope


def slsqp_best(case, count, seed):
    from scipy.optimize import minimize

    start = 0.98 * random_best(case, min(200, count // 5), seed)
    known, rows, n = Known(case, count), linear_rows(case)[::4], case.size
    last = start

    def part(kind, slope):
        here, slopes = known(last_of(slope))
        return here[kind], slopes[kind]

    def last_of(z):
        nonlocal last
        last = z[:n]
        return last

    wide = np.hstack([rows, np.zeros((len(rows), 1))])
    limits = [
        {"type": "ineq", "fun": lambda z: np.hstack([1 - wide @ z, 1 + wide @ z]), "jac": lambda z: np.vstack([-wide, wide])},
        {
            "type": "ineq",
            "fun": lambda z: np.hstack([z[-1] - part(0, z)[0], -part(1, z)[0]]),
            "jac": lambda z: np.vstack(
                [
                    np.hstack([-part(0, z)[1], np.ones((len(part(0, z)[0]), 1))]),
                    np.hstack([-part(1, z)[1].reshape(-1, n), np.zeros((len(part(1, z)[0]), 1))]),
                ]
            ),
        },
    ]
    first = np.append(start, known(start)[0][0].max())
    one = np.eye(n + 1)[-1]
    try:
        options = {"maxiter": 300, "ftol": 1.0e-6}
        bounds = [(-BOX, BOX)] * n + [(None, None)]
        minimize(lambda z: z[-1], first, jac=lambda z: one, bounds=bounds, constraints=limits, method="SLSQP", options=options)
    except StopIteration:
        pass
    return last if known.best[1] is None else known.best[1]


def ipopt_best(case, count, seed):
    import casadi as ca

    start = 0.98 * random_best(case, min(200, count // 5), seed)
    known, rows, n = Known(case, count), linear_rows(case), case.size
    first = known(start)[0]
    m = len(first[0]) + len(first[1])
    state = {"over": False, "at": start}

    def asked(x):
        try:
            state["at"] = np.array(x, dtype=float).ravel()
            return known(x)
        except StopIteration:
            state["over"] = True
            return known.here, known.slope

    class Slopes(ca.Callback):
        def __init__(self, name, opts):
            ca.Callback.__init__(self)
            self.construct(name, opts)

        def get_n_in(self):
            return 2

        def get_n_out(self):
            return 1

        def get_sparsity_in(self, i):
            return ca.Sparsity.dense(n, 1) if i == 0 else ca.Sparsity(m, 1)

        def get_sparsity_out(self, i):
            return ca.Sparsity.dense(m, n)

        def eval(self, arg):
            _, slope = asked(arg[0])
            return [ca.DM(np.vstack([slope[0], slope[1].reshape(-1, n)]))]

    class Values(ca.Callback):
        def __init__(self):
            ca.Callback.__init__(self)
            self.construct("values", {})

        def get_sparsity_in(self, i):
            return ca.Sparsity.dense(n, 1)

        def get_sparsity_out(self, i):
            return ca.Sparsity.dense(m, 1)

        def has_jacobian(self):
            return True

        def get_jacobian(self, name, inames, onames, opts):
            self.slopes = Slopes(name, opts)
            return self.slopes

        def eval(self, arg):
            here, _ = asked(arg[0])
            return [ca.DM(np.hstack(here))]

    class Watch(ca.Callback):
        def __init__(self, size, constraints):
            ca.Callback.__init__(self)
            self.sizes = {"x": size, "f": 1, "g": constraints, "lam_x": size, "lam_g": constraints, "lam_p": 0}
            self.construct("watch", {})

        def get_n_in(self):
            return ca.nlpsol_n_out()

        def get_n_out(self):
            return 1

        def get_name_in(self, i):
            return ca.nlpsol_out(i)

        def get_name_out(self, i):
            return "ret"

        def get_sparsity_in(self, i):
            size = self.sizes[ca.nlpsol_out(i)]
            return ca.Sparsity.dense(size, 1) if size else ca.Sparsity(0, 0)

        def eval(self, arg):
            return [1 if state["over"] else 0]

    values, z = Values(), ca.MX.sym("z", n + 1)
    found = values(z[:n])
    k = len(first[0])
    g = ca.vertcat(found[:k] - z[n], found[k:], ca.DM(rows) @ z[:n])
    watch = Watch(n + 1, m + len(rows))
    options = {
        "iteration_callback": watch,
        "print_time": False,
        "ipopt": {"hessian_approximation": "limited-memory", "print_level": 0, "max_iter": 500, "tol": 1.0e-4, "sb": "yes"},
    }
    solver = ca.nlpsol("solver", "ipopt", {"x": z, "f": z[n], "g": g}, options)
    low = np.hstack([np.full(m, -np.inf), np.full(len(rows), -1.0)])
    high = np.hstack([np.zeros(m), np.ones(len(rows))])
    box = np.append(np.full(n, BOX), np.inf)
    end = solver(x0=np.append(start, first[0].max()), lbx=-box, ubx=box, lbg=low, ubg=high)
    end = case.inside(np.array(end["x"]).ravel()[:n])
    return min([end] + [p for p in [known.best[1]] if p is not None], key=lambda x: case.feasible(x)[0])


def designed(path, program, duration, seed, count):
    """`poinsot design` on the case with another seed."""
    case = open(path).read()
    folder = os.path.dirname(os.path.abspath(path))
    lines = []
    for line in case.splitlines():
        key = line.split("=")[0].strip()
        if key == "model":
            line = f'model = "{os.path.join(folder, tomllib.loads(case)["model"])}"'
        elif key == "duration_s" and duration:
            line = f"duration_s = {duration!r}"
        elif key == "objective":
            line = ""
        elif key == "seed" and lines and "[design]" in lines:
            line = f"seed = {seed}\nevaluations = {count}"
        lines.append(line)
    with tempfile.TemporaryDirectory() as out:
        path = os.path.join(out, "case.toml")
        with open(path, "w") as file:
            file.write("\n".join(lines))
        run = subprocess.run([program, "design", path, "--json"], capture_output=True, check=False)
    found = json.loads(run.stdout)
    return found["worst_ratio"], found["search"]["evaluations"]


def vehicle(seed, folder):
    """A random vehicle of 1 to 5 bodies and a case for it, which nobody tuned for; the path of the case."""
    rng = np.random.default_rng(seed)
    bodies = 1 + seed % 5
    names = [f"b{k}" for k in range(bodies)]
    model = f'schema = "poinsot.model/1"\nname = "vehicle {seed}"\nexact = true\n'
    for k, name in enumerate(names):
        mass = float(rng.uniform(100, 500)) if k == 0 else float(rng.uniform(5, 40))
        size = (mass / 300.0) ** (1 / 3)
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        points = rng.normal(size=(8, 3)) * size * rng.uniform(0.2, 0.6, size=3)
        spread = mass * points.T @ points / len(points)
        tensor = turn @ (np.trace(spread) * np.eye(3) - spread) @ turn.T
        entry = ", ".join(f"{a}{b} = {float(tensor['xyz'.index(a), 'xyz'.index(b)])!r}" for a, b in ("xx", "yy", "zz", "xy", "xz", "yz"))
        model += f'[[body]]\nname = "{name}"\nmass_kg = {mass!r}\ncom_m = {(0.1 * size * rng.normal(size=3)).tolist()}\n'
        model += f"inertia_kg_m2 = {{ {entry} }}\n"
        if k == bodies - 1:
            model += 'estimate = ["inertia"]\n' if bodies == 1 else "estimate = true\n"
    for k, name in enumerate(names[1:], 1):
        axis = rng.normal(size=3)
        model += f'[[joint]]\nname = "j{k}"\ntype = "revolute"\nparent = "{names[int(rng.integers(k))]}"\nchild = "{name}"\n'
        model += f"origin_m = {rng.uniform(-0.6, 0.6, size=3).tolist()}\naxis = {(axis / np.linalg.norm(axis)).tolist()}\n"
    for k, axis in enumerate(np.eye(3).tolist()):
        model += f'[[wheel]]\nname = "w{k}"\nbody = "b0"\naxis = {axis}\nspin_inertia_kg_m2 = 0.01\n'
    for name, kind, noise in [
        ("gyro", "gyro", "noise_rad_s = 5.0e-5"),
        ("tracker", "attitude", "noise_rad = 5.0e-5"),
        ("position", "position", "noise_m = 0.001"),
    ][: 2 if bodies == 1 else 3]:
        model += f'[[sensor]]\nname = "{name}"\ntype = "{kind}"\n{noise}\n'
    case = f'schema = "poinsot.case/2"\nmodel = "model.toml"\nduration_s = 60.0\n[initial]\nmomentum_zero = true\n'
    case += f'[output]\nrate_hz = 5\n[design]\nseed = 1\n'
    number = f"{names[-1]}.inertia_kg_m2"
    case += "[[design.wheel]]\nnodes = 7\n[limits]\nbody_rate_rad_s = 0.04\n"
    case += "[[limits.wheel]]\nspeed_rad_s = 300.0\ntorque_N_m = 0.3\n"
    if bodies > 1:
        case += '[[design.joint]]\nform = "fourier"\nharmonics = 3\n'
        case += "[[limits.joint]]\nposition_rad = [-0.6, 0.6]\nrate_rad_s = 0.12\n"
        case += f'[[want]]\nnumber = "{names[-1]}.mass_kg"\nrelative = 1.0e-3\n'
    case += f'[[want]]\nnumber = "{number}"\nrelative = 1.0e-3\n'
    for file, text in (("model.toml", model), ("case.toml", case)):
        with open(os.path.join(folder, file), "w") as out:
            out.write(text)
    return os.path.join(folder, "case.toml")


FIND = {"slsqp": slsqp_best, "cma": cma_best, "random": random_best, "ipopt": ipopt_best}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="?")
    parser.add_argument("--vehicle", type=int, help="a random vehicle of this seed instead of a case")
    parser.add_argument("--poinsot", default="target/release/poinsot")
    parser.add_argument("--method", nargs="+", choices=[*FIND, "design"], default=["slsqp"])
    parser.add_argument("--evaluations", type=int, default=5000)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1])
    parser.add_argument("--duration", type=float, help="duration instead of that of the case, s")
    words = parser.parse_args()
    if (words.case is None) == (words.vehicle is None):
        parser.error("give either a case or --vehicle")
    with tempfile.TemporaryDirectory() as folder:
        compare(words, words.case or vehicle(words.vehicle, folder))


def compare(words, path):
    for method in words.method:
        for seed in words.seeds:
            start = time.time()
            if method == "design":
                ratio, count = designed(path, words.poinsot, words.duration, seed, words.evaluations)
            else:
                case = Case(path, words.poinsot, words.duration)
                at = FIND[method](case, words.evaluations, seed)
                count = case.evaluations
                ratio = math.exp(case.feasible(at)[0])
            print(f"{method} seed {seed}: worst ratio {ratio:.4f}, {count} evaluations, {time.time() - start:.0f} s", flush=True)


if __name__ == "__main__":
    main()
