#!/usr/bin/env python3
"""Draws docs/picture.svg and the figures of the explanation pages, docs/explanation/figures/*.svg, from output of the program.

    scripts/figures                     build and run the program, write the figures
    scripts/figures --check             fail if a figure is not what would be written
    scripts/figures --poinsot PATH      use a program that is already built
"""

import argparse
import csv
import json
import math
import subprocess
import sys
from pathlib import Path

from picture import FAINT, GRID, HIT, INK, ROOT, SIGMA, START, picture, text

FOLDER = ROOT / "docs/explanation/figures"
WORK = "target/figures"  # inputs and outputs of the runs, from the root
WIDTH, HEIGHT = 720, 360
LEFT, RIGHT, TOP, BOTTOM = 76, 700, 60, 300  # frame of a plot with axes
LINES = [HIT, START, "#2e7d4f"]
ANSWERED = (0, 1)
MOMENTS = (14.0, 17.0, 20.0)  # of the body that coasts, kg m2
RATE = 0.1  # largest rate of the coasting body, rad/s
WHEEL_SPEED, WHEEL_INERTIA = 600.0, 4.113e-4  # rad/s, kg m2

BODY = """schema = "poinsot.model/1"
name = "body"
exact = true
[[body]]
name = "body"
mass_kg = 150.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = {{ xx = {0}, yy = {1}, zz = {2}, xy = 0.0, xz = 0.0, yz = 0.0 }}
estimate = ["inertia"]
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1e-12
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 1e-12
[momentum]
linear_N_s = "estimate"
angular_N_m_s = "estimate"
"""
WHEEL = f"""[[wheel]]
name = "wheel"
body = "body"
axis = [0.0, 1.0, 0.0]
spin_inertia_kg_m2 = {WHEEL_INERTIA}
[[sensor]]
name = "tachometer"
type = "wheel_speed"
noise_rad_s = 1e-9
"""
WHEEL_MOTION = f"""[[wheel_motion]]
wheel = "wheel"
time_s = [0.0]
speed_rad_s = [{WHEEL_SPEED}]
"""


class Runs:
    """The program and what it printed."""

    def __init__(self, poinsot):
        self.poinsot = poinsot

    def json(self, *words):
        done = subprocess.run([self.poinsot, *words, "--json"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode not in ANSWERED:
            sys.exit(f"figures.py: exit code {done.returncode}: poinsot {' '.join(words)}\n{done.stderr}")
        return json.loads(done.stdout)

    def rates(self, name, omega, duration, wheel=False):
        """Times and angular velocity of a body that coasts."""
        folder = ROOT / WORK / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.toml").write_text(BODY.format(*MOMENTS) + (WHEEL if wheel else ""))
        start = ", ".join(f"{w:.9f}" for w in omega)
        (folder / "case.toml").write_text(
            f'schema = "poinsot.case/2"\nmodel = "model.toml"\nduration_s = {duration}\n[initial]\nomega_rad_s = [{start}]\n'
            f"{WHEEL_MOTION if wheel else ''}[output]\nrate_hz = 1\nsensors_only = true\nseed = 1\n"
        )
        command = [self.poinsot, "simulate", f"{WORK}/{name}/case.toml", "--out", f"{WORK}/{name}", "--quiet"]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE)
        with open(folder / "telemetry.csv") as file:
            rows = list(csv.DictReader(file))
        return [float(r["time_s"]) for r in rows], [[float(r[f"omega_{axis}"]) for axis in "xyz"] for r in rows]


def svg(title, parts, height=HEIGHT):
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" '
        "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">"
    )
    background = f'<rect width="{WIDTH}" height="{height}" fill="white"/>'
    return "\n".join([head, f"<title>{title}</title>", background, text(24, 30, title, 16, weight="bold"), *parts, "</svg>"]) + "\n"


def thin(points, gap=3.0):
    """Points at least some pixels apart, up to where a closed path returns."""
    kept, away = points[:1], False
    for point in points[1:-1]:
        if math.dist(point, kept[-1]) < gap:
            continue
        if away and math.dist(point, points[0]) < 2 * gap:
            return [*kept, points[0]]
        away = away or math.dist(point, points[0]) > 4 * gap
        kept.append(point)
    return [*kept, points[-1]]


def line(points, colour, width=1.8, dash=""):
    path = "".join(f"{'M' if k == 0 else 'L'}{x:.1f} {y:.1f}" for k, (x, y) in enumerate(points))
    dashes = f' stroke-dasharray="{dash}"' if dash else ""
    return f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width}"{dashes}/>'


def frame(xs, ys, x_label, y_label, x_name=str, y_name=str, at=lambda low, high, v: (v - low) / (high - low)):
    """Grid, ticks and names of a plot, and the function that places a point."""

    def place(x, y):
        across = LEFT + (RIGHT - LEFT) * at(xs[0], xs[-1], x)
        return across, BOTTOM - (BOTTOM - TOP) * at(ys[0], ys[-1], y)

    out = []
    for x in xs:
        px = place(x, ys[0])[0]
        out += [f'<path d="M{px:.1f} {TOP}V{BOTTOM}" stroke="{GRID}"/>', text(round(px, 1), BOTTOM + 18, x_name(x), 12, FAINT, "middle")]
    for y in ys:
        py = place(xs[0], y)[1]
        out += [f'<path d="M{LEFT} {py:.1f}H{RIGHT}" stroke="{GRID}"/>', text(LEFT - 8, round(py + 4, 1), y_name(y), 12, FAINT, "end")]
    out.append(text((LEFT + RIGHT) / 2, BOTTOM + 40, x_label, 12.5, FAINT, "middle"))
    out.append(text(24, 50, y_label, 12.5, FAINT))
    return out, place


def legend(names, x, y):
    out = []
    for k, (name, colour, dash) in enumerate(names):
        top = y + 20 * k
        out += [line([(x, top), (x + 26, top)], colour, 2, dash), text(x + 34, top + 4, name, 12.5)]
    return out


# Rotation from body axes to the picture: seen from between the axes.
def seen(v):
    turn, rise = math.radians(35), math.radians(22)
    x = -math.sin(turn) * v[0] + math.cos(turn) * v[1]
    depth = math.cos(turn) * v[0] + math.sin(turn) * v[1]
    return x, math.cos(rise) * v[2] - math.sin(rise) * depth, math.cos(rise) * depth + math.sin(rise) * v[2]


def polhode(runs):
    """Paths of the angular velocity on the ellipsoid of equal energy."""
    energy = MOMENTS[0] * RATE**2  # twice the kinetic energy
    axes = [math.sqrt(energy / moment) for moment in MOMENTS]
    starts = [(1, 0.16, 0), (1, 0.36, 0), (1, 0.62, 0), (0, 0.16, 1), (0, 0.36, 1), (0, 0.62, 1), (0.03, 1, 0.03), (-0.03, -1, 0.03)]
    starts += [tuple(-v for v in start) for start in starts[:6]]
    scale, centre = 1350.0, (250, 205)

    def place(v):
        x, y, _ = seen(v)
        return centre[0] + scale * x, centre[1] - scale * y

    rim = [[a * math.cos(t) * p + a * math.sin(t) * q for a, p, q in zip(axes, u, w)] for u, w in ((silhouette(axes)),) for t in steps(120)]
    parts = [line([place(v) for v in rim], FAINT, 1.2)]
    drift = 0.0
    for k, direction in enumerate(starts):
        size = math.sqrt(energy / sum(m * d * d for m, d in zip(MOMENTS, direction)))
        _, omega = runs.rates(f"polhode{k}", [size * d for d in direction], 900)
        spins = [math.sqrt(sum((m * w) ** 2 for m, w in zip(MOMENTS, row))) for row in omega]
        drift = max(drift, max(abs(h / spins[0] - 1) for h in spins))
        kind = 0 if abs(direction[0]) == 1 else 1 if abs(direction[2]) == 1 else 2
        normals = [[w / (a * a) for w, a in zip(row, axes)] for row in omega]
        for front in (False, True):
            piece = []
            for row, normal in [*zip(omega, normals), (None, None)]:
                if row is not None and (seen(normal)[2] > 0) == front:
                    piece.append(place(row))
                    continue
                if len(piece) > 1:
                    parts.append(line(thin(piece), LINES[kind] if front else GRID, 1.8 if front else 1.2))
                piece = []
    for k, name in enumerate("xyz"):
        tip = [1.3 * axes[i] if i == k else 0.0 for i in range(3)]
        foot = [axes[i] if i == k else 0.0 for i in range(3)]
        (x, y) = place(tip)
        parts += [line([place(foot), (x, y)], INK, 1.2), text(round(x + 6, 1), round(y + 4, 1), name, 13)]
    names = [
        (f"about x, the smallest moment ({MOMENTS[0]:.0f} kg m²)", LINES[0], ""),
        (f"about z, the largest moment ({MOMENTS[2]:.0f} kg m²)", LINES[1], ""),
        (f"past y, the middle moment ({MOMENTS[1]:.0f} kg m²)", LINES[2], ""),
    ]
    parts += legend(names, 455, 120)
    parts.append(text(455, 200, f"{len(starts)} runs of poinsot simulate, 900 s each", 12.5, FAINT))
    parts.append(text(455, 220, f"momentum constant to {ceiling(drift)}", 12.5, FAINT))
    parts.append(text(24, 50, "angular velocity in body axes, on the ellipsoid of its kinetic energy; back side in grey", 12.5, FAINT))
    return svg("Polhodes: the coasting body returns, and shows ratios of its moments", parts)


def ceiling(value):
    """The next power of ten, so that round-off of another machine changes nothing."""
    return f"1e{max(math.ceil(math.log10(value)), -11)}" if value > 0 else "round-off"


def steps(n):
    return [2 * math.pi * k / n for k in range(n + 1)]


def silhouette(axes):
    """Two directions, on the unit sphere, that span the rim of an ellipsoid as seen."""
    view = [seen([float(i == k) for i in range(3)])[2] for k in range(3)]
    normal = [v / a for v, a in zip(view, axes)]
    size = math.sqrt(sum(n * n for n in normal))
    n = [x / size for x in normal]
    u = [-n[1], n[0], 0.0]
    size = math.hypot(*u[:2])
    u = [x / size for x in u]
    return u, [n[1] * u[2] - n[2] * u[1], n[2] * u[0] - n[0] * u[2], n[0] * u[1] - n[1] * u[0]]


def unobservable(runs):
    """Elements of the tensor along one unobservable direction, and a combination that stays."""
    answer = runs.json("identify", "--model", "data/stsat3/model.toml", "--telemetry", "data/stsat3/paper/telemetry.parquet")
    found = answer["identifiability"]
    walk = found["not_identifiable"][0]["walk"]
    kept = found["identifiable"][0]
    place_of = {name: values for name, values in walk.items()}
    points = len(next(iter(walk.values())))
    along = [-20 + 40 * k / (points - 1) for k in range(points)]
    stays = [sum(c * place_of[name][k] for name, c in kept["coefficients"].items()) for k in range(points)]
    out, place = frame([-20, -10, 0, 10, 20], [-10, 0, 10, 20, 30, 40, 50], "step along the direction, % of the natural scale", "kg m²")
    shown = [("xx", LINES[0]), ("zz", LINES[1]), ("xz", LINES[2])]
    for element, colour in shown:
        out.append(line([place(x, y) for x, y in zip(along, place_of[f"spacecraft.inertia_kg_m2.{element}"])], colour, 2))
    out.append(line([place(x, y) for x, y in zip(along, stays)], INK, 2, "6 4"))
    width = max(stays) - min(stays)
    names = [(f"I_{element}", colour, "") for element, colour in shown]
    names.append((f"I_xx + I_xz + 1.19 I_xy: changes by less than {ceiling(width)} kg m²", INK, "6 4"))
    out += [f'<rect x="{LEFT + 6}" y="64" width="420" height="84" fill="white"/>', *legend(names, LEFT + 16, 78)]
    return svg("One slew: the tensor moves along a direction, and no measurement changes", out)


def errors_in_variables(runs):
    """Bias of one moment against noise, for methods with noise in the regressor and without."""
    factors = [1, 4, 16]
    methods = [("linear", "linear: noise in the regressor", LINES[1]), ("kim2010/batch", "kim2010/batch: noise in the regressor", LINES[2])]
    methods.append(("auto", "maximum likelihood: noise in the residual", LINES[0]))
    words = ["sweep", "data/cases/stsat3_three_slews.toml", "--vary", "noise=" + ",".join(map(str, factors)), "--trials", "6"]
    answer = runs.json(*words, *(word for name, _, _ in methods for word in ("--method", name)))
    number = "spacecraft.inertia_kg_m2.xx"
    decades = [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0]

    def at(low, high, value):
        return math.log(max(value, low) / low) / math.log(high / low)

    out, place = frame(factors, decades, "noise of all sensors, times that of STSAT-3", "error of I_xx, kg m²", y_name=lambda v: tick(v), at=at)
    bounds = [cell["methods"][0]["numbers"][number]["bound"] for cell in answer["cells"]]
    out.append(line([place(x, y) for x, y in zip(factors, bounds)], FAINT, 1.5, "3 4"))
    for k, (_, _, colour) in enumerate(methods):
        errors = [cell["methods"][k]["numbers"][number]["rmse"]["value"] for cell in answer["cells"]]
        out.append(line([place(x, y) for x, y in zip(factors, errors)], colour, 2))
        out += [f'<circle cx="{place(x, y)[0]:.1f}" cy="{place(x, y)[1]:.1f}" r="4" fill="{colour}"/>' for x, y in zip(factors, errors)]
    names = [(words, colour, "") for _, words, colour in methods] + [("Cramer-Rao bound", FAINT, "3 4")]
    out += [f'<rect x="{LEFT + 6}" y="66" width="290" height="84" fill="white"/>', *legend(names, LEFT + 16, 82)]
    return svg("Errors in variables: root mean square error of six trials against noise", out)


def tick(value):
    """A power of ten as text of a figure."""
    exponent = str(round(math.log10(value))).replace("-", "\u2212")
    return f'10<tspan font-size="9" dy="-5">{exponent}</tspan><tspan dy="5">\u200b</tspan>'


def nutation(runs):
    """Rates across a wheel that stores momentum, and the period of the formula."""
    duration = 1200
    times, omega = runs.rates("nutation", (2e-3, 0.0, 0.0), duration, wheel=True)
    stored = WHEEL_SPEED * WHEEL_INERTIA
    period = 2 * math.pi * math.sqrt(MOMENTS[0] * MOMENTS[2]) / stored
    rises = [k for k in range(1, len(times)) if omega[k - 1][2] < 0 <= omega[k][2]]
    cross = [times[k] - omega[k][2] / (omega[k][2] - omega[k - 1][2]) * (times[k] - times[k - 1]) for k in rises]
    measured = (cross[-1] - cross[0]) / (len(cross) - 1)
    out, place = frame([0, 300, 600, 900, 1200], [-2, -1, 0, 1, 2, 3], "time, s", "angular velocity, mrad/s")
    for axis, colour in ((0, LINES[0]), (2, LINES[1])):
        out.append(line(thin([place(t, 1e3 * w[axis]) for t, w in zip(times, omega)]), colour, 2))
    (begin, y), (end, _) = place(cross[0], 2.3), place(cross[1], 2.3)
    out += [line([(begin, y), (end, y)], INK, 1.4), line([(begin, y - 5), (begin, y + 5)], INK), line([(end, y - 5), (end, y + 5)], INK)]
    words = f"simulated {measured:.1f} s, 2π √(I₁ I₃) / h = {period:.1f} s"
    out.append(text(round((begin + end) / 2, 1), round(y - 10, 1), words, 12.5, INK, "middle"))
    out += legend([("about x", LINES[0], ""), ("about z", LINES[1], "")], RIGHT - 96, 74)
    return svg(f"Nutation: a wheel about y stores {stored:.3f} N m s, and the body turns about x and z", out)


def flexible(runs):
    """Gyro residual of a vehicle with sloshing propellant, without and with the mode that is found."""
    simulated = [runs.poinsot, "simulate", "data/cases/slosh.toml", "--out", f"{WORK}/flexible", "--quiet"]
    subprocess.run(simulated, cwd=ROOT, check=True, stdout=subprocess.PIPE)
    names, begin, end = {"none": "rigid model", "found": "with the mode that is found"}, 30, 90
    out, place = frame([*range(begin, end + 1, 10)], [-80, -40, 0, 40, 80], "time, s", "residual of the gyro about y, µrad/s")
    for modes, colour in zip(names, LINES):
        folder = f"{WORK}/flexible/{modes}"
        asked = ["identify", "-m", "data/cases/rigid_bus.toml", "-t", f"{WORK}/flexible/telemetry.csv", "--modes", modes]
        runs.json(*asked, "--out", folder, "--report")
        gyro = json.loads((ROOT / folder / "report_data.json").read_text())["segments"][0]["channels"][0]
        shown = [(t, 1e6 * r) for t, r in zip(gyro["time_s"], gyro["residual"][1]) if begin <= t <= end]
        out.append(line([place(*point) for point in shown], colour, 1.6))
    out += legend([(name, colour, "") for name, colour in zip(names.values(), LINES)], LEFT + 12, 74)
    return svg("Slosh: a rigid model leaves an oscillation, a mode leaves noise", out)


FIGURES = {
    ROOT / "docs/picture.svg": picture,
    FOLDER / "polhode.svg": polhode,
    FOLDER / "unobservable_direction.svg": unobservable,
    FOLDER / "errors_in_variables.svg": errors_in_variables,
    FOLDER / "nutation.svg": nutation,
    FOLDER / "flexible.svg": flexible,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", default="target/release/poinsot", help="program to use; scripts/figures builds the default")
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    arguments = parser.parse_args()
    runs = Runs(str(Path(arguments.poinsot).resolve()))
    stale = []
    for path, draw in FIGURES.items():
        drawn = draw(runs)
        if not path.exists() or path.read_text() != drawn:
            stale.append(str(path.relative_to(ROOT)))
            if not arguments.check:
                path.parent.mkdir(exist_ok=True)
                path.write_text(drawn)
        print(f"{path.relative_to(ROOT)}: {len(drawn)} bytes")
    if arguments.check and stale:
        sys.exit("out of date, run scripts/figures:\n  " + "\n  ".join(stale))


if __name__ == "__main__":
    main()
