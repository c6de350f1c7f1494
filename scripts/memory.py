"""Memory of reading and of identifying long telemetry: peak resident size at several lengths, and its slope.

    python3 scripts/memory.py --poinsot target/release/poinsot [--gib 10]

Writes telemetry of a satellite with three wheels to a temporary folder, measures, and deletes it.
"""

import argparse
import math
import os
import resource
import subprocess
import tempfile
import time

MODEL = """schema = "poinsot.model/1"
name = "sat"
[[body]]
name = "bus"
mass_kg = 150.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 15.0, yy = 16.0, zz = 21.0, xy = 0.0, xz = 0.0, yz = 0.0 }
estimate = ["inertia"]
[[wheel]]
name = "wheel1"
body = "bus"
axis = [1.0, 0.0, 0.0]
spin_inertia_kg_m2 = 0.0004113
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1e-4
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 5e-5
"""


def telemetry(path, rows):
    """A wheel swings about x, the body answers; other columns are there to be left out."""
    inertia, spin = 15.0, 0.0004113
    with open(path, "w") as out:
        out.write("time_s,omega_x,omega_y,omega_z,q_x,q_y,q_z,q_w,wheel1_rad_s")
        out.write("".join(f",house{k}" for k in range(8)) + "\n")
        rest = ",21.500000000" * 8 + "\n"
        for k in range(rows):
            t = 0.01 * k
            wheel = 100.0 * math.sin(0.05 * t)
            angle = spin / inertia * 100.0 / 0.05 * (math.cos(0.05 * t) - 1.0)
            rate = -spin / inertia * wheel
            half = 0.5 * angle
            out.write(
                f"{t:.2f},{rate!r},0.0,0.0,{math.sin(half)!r},0.0,0.0,{math.cos(half)!r},{wheel!r}{rest}"
            )


def measure(arguments):
    start = time.time()
    pid = os.posix_spawn(
        arguments[0],
        arguments,
        os.environ,
        file_actions=[(os.POSIX_SPAWN_OPEN, fd, "/dev/null", os.O_WRONLY, 0) for fd in (1, 2)],
    )
    _, status, usage = os.wait4(pid, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_maxrss / 1024, time.time() - start


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--poinsot", required=True)
    parser.add_argument("--rows", type=int, nargs="*", default=[20_000, 40_000, 80_000])
    parser.add_argument("--long", type=int, default=2_000_000, help="rows that are read with --every")
    options = parser.parse_args()
    program = os.path.abspath(options.poinsot)
    with tempfile.TemporaryDirectory() as folder:
        model, file = os.path.join(folder, "m.toml"), os.path.join(folder, "t.csv")
        with open(model, "w") as out:
            out.write(MODEL)
        print("command            rows      MiB read  exit  peak MiB  seconds")
        for rows in options.rows:
            telemetry(file, rows)
            size = os.path.getsize(file) / 2**20
            for name, arguments in [
                ("inspect", ["inspect", file]),
                ("identify linear", ["identify", "--method", "linear", "--model", model, "--telemetry", file]),
            ]:
                code, peak, seconds = measure([program, *arguments])
                print(f"{name:16} {rows:9} {size:12.0f} {code:5} {peak:9.1f} {seconds:8.1f}")
        telemetry(file, options.long)
        size = os.path.getsize(file) / 2**20
        for name, arguments in [
            ("inspect", ["inspect", file]),
            ("inspect 1/100", ["inspect", "--every", "100", file]),
            ("identify 1/100", ["identify", "--method", "linear", "--model", model, "--telemetry", file, "--every", "100"]),
            ("identify all", ["identify", "--method", "linear", "--model", model, "--telemetry", file]),
        ]:
            code, peak, seconds = measure([program, *arguments])
            print(f"{name:16} {options.long:9} {size:12.0f} {code:5} {peak:9.1f} {seconds:8.1f}")


if __name__ == "__main__":
    main()
