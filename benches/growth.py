#!/usr/bin/env python3
"""Processor time and memory over samples, bodies, unknowns, sensors, segments, firings, correlation lengths and rows of a file.

    scripts/bench-growth                   # minutes
    scripts/bench-growth --only bodies
    scripts/bench-growth --only rows --most 1000000    # up to 10^8 rows, a temporary file of 5 GB

Every record is simulated, with noise, and identified; a long file is inspected in parts. Prints one table each; the order is the
exponent between neighbouring lines.
"""

import argparse
import math
import os
import random
import shutil
import subprocess
import tempfile
from pathlib import Path

DURATION = 60.0  # s, of every record
ARM_RATE = 5  # Hz
BUS_RATE = 50  # Hz, where it is not what grows
ANSWERED = (0, 1)
ROW_BYTES = 50  # of a long file
SPARE = 2  # times the size of a long file that the disk must have free
STREAMED = 100  # rows of the longest file for a sample of the longest record

BODY = """[[body]]
name = "{name}"
mass_kg = {mass}
com_m = [{com}, 0.0, 0.0]
inertia_kg_m2 = {{ xx = {xx}, yy = {yy}, zz = {zz}, xy = 0.0, xz = 0.0, yz = 0.0 }}
"""
JOINT = """[[joint]]
name = "joint{k}"
type = "revolute"
parent = "{parent}"
child = "link{k}"
origin_m = [{at}, 0.0, 0.0]
axis = {axis}
"""
MOTION = """[[joint_motion]]
joint = "joint{k}"
interpolation = "fourier"
base_frequency_hz = 0.05
sine_rad = [{a}, {b}]
cosine_rad = [0.0, 0.1]
"""
SENSOR = """[[sensor]]
name = "{name}"
type = "{kind}"
noise_{unit} = {noise}
"""
THRUSTERS = [
    ([-0.7, -0.2, 0.0], [1.0, 0.0, 0.0]),
    ([0.35, 0.35, 0.2], [0.0, -1.0, 0.0]),
    ([-0.55, 0.35, 0.0], [0.0, 0.0, -1.0]),
    ([0.0, 0.2, 0.0], [-1.0, 0.0, 0.0]),
]
THRUSTER = """[[thruster]]
name = "thruster{k}"
body = "bus"
position_m = {place}
force_direction = {direction}
"""
FIRING = """[[firing]]
thruster = "thruster{k}"
on_s = {on:.4f}
off_s = {off:.4f}
force_N = 5.0
"""
MODEL = 'schema = "poinsot.model/1"\nname = "vehicle"\nexact = true\n'
RANDOM_TORQUE = """[environment]
random_torque = {{ sigma_N_m = 1e-4, correlation_s = {correlation_s} }}
"""
SLEW = 1_000  # rows whose values a long file repeats, each with its own time
MOMENTUM = '[momentum]\nlinear_N_s = "estimate"\nangular_N_m_s = "estimate"\n'
POSE = [
    ("tracker", "attitude", "rad", 5e-5),
    ("position", "position", "m", 0.002),
    ("velocity", "velocity", "m_s", 0.0002),
]


def sensors(gyros=1):
    all_gyros = [("gyro" if k == 0 else f"gyro{k + 1}", "gyro", "rad_s", 2e-5) for k in range(gyros)]
    keys = ("name", "kind", "unit", "noise")
    return "".join(SENSOR.format(**dict(zip(keys, one))) for one in all_gyros + POSE)


def arm(links, unknown):
    """A base with a chain of links, of which the last ones are to be found: model and motion."""
    text, motion = MODEL + BODY.format(name="base", mass=400.0, com=0.0, xx=60.0, yy=70.0, zz=80.0), ""
    for k in range(1, links + 1):
        size = 1.0 / max(1, links // 6)
        text += BODY.format(name=f"link{k}", mass=20 * size, com=0.4 * size, xx=0.1 * size, yy=2 * size, zz=2 * size)
        text += "estimate = true\n" if k > links - unknown else ""
        motion += MOTION.format(k=k, a=0.5 * math.cos(k) / math.sqrt(links), b=0.4 * math.sin(2 * k) / math.sqrt(links))
    for k in range(1, links + 1):
        parent = "base" if k == 1 else f"link{k - 1}"
        axis = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]][k % 3]
        text += JOINT.format(k=k, parent=parent, at=0.8 / max(1, links // 6), axis=axis)
    return text + sensors() + MOMENTUM, motion


def bus(gyros=1, firings=10):
    """One body with thrusters: model and firings, a fifth of the time on."""
    body = BODY.format(name="bus", mass=500.0, com=0.03, xx=82.0, yy=95.0, zz=110.0) + "estimate = true\n"
    each = [THRUSTER.format(k=k, place=p, direction=d) for k, (p, d) in enumerate(THRUSTERS)]
    period = (DURATION - 2.0) / firings
    on = [1.0 + period * (k + 0.3) for k in range(firings)]
    moves = "".join(FIRING.format(k=k % 4, on=t, off=t + 0.2 * period) for k, t in enumerate(on))
    return MODEL + body + "".join(each) + sensors(gyros) + MOMENTUM, moves


def case(motion, rate, seed):
    start = "[initial]\nomega_rad_s = [0.03, -0.02, 0.05]\nv_m_s = [0.01, 0.005, -0.008]\n"
    head = f'schema = "poinsot.case/1"\nmodel = "model.toml"\nduration_s = {DURATION}\n'
    return f"{head}{start}{motion}[output]\nrate_hz = {rate}\nseed = {seed}\n"


def used_by(command):
    """Seconds of the processor, MiB at most and exit code of one command."""
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0, os.waitstatus_to_exitcode(status)


def identified(poinsot, model, motion, rate, segments=1):
    """One identification of simulated records."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "model.toml").write_text(model)
        command = [poinsot, "identify", "--quiet", "--model", folder / "model.toml", "--out", folder / "answer"]
        for k in range(segments):
            (folder / "case.toml").write_text(case(motion, rate, 1 + k))
            out = folder / f"run{k}"
            subprocess.run([poinsot, "simulate", "--quiet", folder / "case.toml", "--out", out], check=True)
            command += ["--telemetry", out / "telemetry.csv"]
        return used_by(command)


def inspected(poinsot, rows):
    """One inspection of a gyro's rows at 1 kHz, written here."""
    noise = random.Random(1)
    values = [",".join(f"{noise.gauss(0.01, 1e-4):.9f}" for _ in range(3)) for _ in range(SLEW)]
    with tempfile.TemporaryDirectory() as folder:
        if shutil.disk_usage(folder).free < SPARE * ROW_BYTES * rows:
            raise SystemExit(f"{folder}: needs {SPARE * ROW_BYTES * rows / 1e9:.0f} GB free; name another folder by TMPDIR")
        file = Path(folder) / "telemetry.csv"
        with file.open("w") as out:
            out.write("time_s,omega_x,omega_y,omega_z\n")
            for first in range(0, rows, SLEW):
                out.writelines(f"{1e-3 * (first + k):.3f},{line}\n" for k, line in enumerate(values[: rows - first]))
        return used_by([poinsot, "inspect", "--quiet", file])


def growths(most):
    """Name of every table; of its lines what is counted and what is measured with the program."""
    for name, lines in records(most):
        yield name, [(n, lambda poinsot, of=of: identified(poinsot, *of)) for n, of in lines]
    rows = [n for n in (100_000, 1_000_000, 10_000_000, 100_000_000) if n <= STREAMED * most]
    yield "rows", [(n, lambda poinsot, n=n: inspected(poinsot, n)) for n in rows]


def records(most):
    """Model, motion, rate and segments of every line that is identified."""
    rates = [n for n in (1_000, 10_000, 100_000, 1_000_000) if n <= most]
    yield "samples", [(n, (*bus(), n / DURATION, 1)) for n in rates]
    yield "bodies", [(n + 1, (*arm(n, 1), ARM_RATE, 1)) for n in (1, 3, 10, 30, 100, 300, 1_000)]
    yield "unknowns", [(10 * n, (*arm(12, n), ARM_RATE, 1)) for n in (1, 2, 4, 8, 12)]
    yield "sensors", [(n + 3, (*bus(gyros=n), BUS_RATE, 1)) for n in (1, 3, 10, 30, 100)]
    yield "segments", [(n, (*bus(), BUS_RATE, n)) for n in (1, 3, 10, 30)]
    yield "firings", [(n, (*bus(firings=n), BUS_RATE, 1)) for n in (10, 100, 1_000)]
    model, moves = bus()
    lengths = [(n, model + RANDOM_TORQUE.format(correlation_s=DURATION / n)) for n in (6, 60, 600, 6_000)]
    yield "correlations", [(n, (torque, moves, ARM_RATE, 1)) for n, torque in lengths]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", default="target/release/poinsot", help="program to use; scripts/bench-growth builds the default")
    parser.add_argument("--only", help="one of the tables")
    parser.add_argument("--most", type=int, default=100_000, help="samples of the longest record")
    arguments = parser.parse_args()
    poinsot = str(Path(arguments.poinsot).resolve())
    for name, lines in growths(arguments.most):
        if arguments.only not in (None, name):
            continue
        print(f"\n| {name} | processor time, s | order | memory, MiB | exit |\n|---|---|---|---|---|", flush=True)
        before = None
        for count, measured in lines:
            seconds, memory, code = measured(poinsot)
            if code not in ANSWERED:
                raise SystemExit(f"{name} {count}: exit {code}")
            order = math.log(seconds / before[1]) / math.log(count / before[0]) if before else None
            print(f"| {count} | {seconds:.2f} | {'' if order is None else f'{order:.2f}'} | {memory:.0f} | {code} |", flush=True)
            before = (count, seconds)


if __name__ == "__main__":
    main()
