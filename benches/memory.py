"""Memory and time of reading long telemetry: a few lengths, or one file of any size.

    scripts/bench-memory
    scripts/bench-memory --gb 10 --format csv      # or parquet
    scripts/bench-memory --write FILE.csv --gb 10  # the file alone

A satellite with three wheels, a gyro and a star tracker at 1 kHz, and eight columns that nobody asks for. Needs numpy,
pyarrow and /usr/bin/time. The file lies in `--folder` (a temporary one) and is deleted.
"""

import argparse
import os
import subprocess
import tempfile
import time

import numpy as np
import pyarrow as pa
import pyarrow.csv as pacsv
import pyarrow.parquet as pq

WHEEL = """[[wheel]]
name = "wheel{k}"
body = "bus"
axis = {axis}
spin_inertia_kg_m2 = 0.0004113
"""
MODEL = """schema = "poinsot.model/1"
name = "sat"
exact = true
[[body]]
name = "bus"
mass_kg = 150.0
com_m = [0.0, 0.0, 0.0]
inertia_kg_m2 = { xx = 15.0, yy = 16.0, zz = 21.0, xy = 0.0, xz = 0.0, yz = 0.0 }
estimate = ["inertia"]
""" + "".join(WHEEL.format(k=k + 1, axis=[float(k == j) for j in range(3)]) for k in range(3)) + """[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1e-4
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 5e-5
"""
I_BBcm_B = np.array([[13.916, 0.085, 0.133], [0.085, 16.954, 0.5896], [0.133, 0.5896, 19.894]])
SPIN, PEAK, PERIOD, STEP = 0.0004113, 150.0, 120.0, 0.001
ROWS = round(PERIOD / STEP)
NAMES = ["time_s", "omega_x", "omega_y", "omega_z", "q_x", "q_y", "q_z", "q_w"]
NAMES += [f"wheel{k}_rad_s" for k in (1, 2, 3)] + [f"house{k}" for k in range(8)]


def slew(number, seed=7):
    """The rows of one slew, 120 s, without their times.

    One wheel after the other turns the vehicle, which is without momentum, and back: I w + Js Omega e = 0, so w keeps
    its direction in the body, I^-1 e, and the attitude is one turn about it.
    """
    rng = np.random.default_rng([seed, number])
    n = ROWS
    x = 2.0 * np.pi * np.arange(n) / n
    speed = PEAK * np.sin(x) ** 3
    swept = PEAK * PERIOD / (2.0 * np.pi) * (np.cos(x) ** 3 / 3.0 - np.cos(x) + 2.0 / 3.0)
    direction = -SPIN * np.linalg.solve(I_BBcm_B, np.eye(3)[number % 3])
    omega = np.outer(speed, direction) + 1e-4 * rng.standard_normal((n, 3))
    turn = np.outer(swept, direction) + 5e-5 * rng.standard_normal((n, 3))
    angle = np.linalg.norm(turn, axis=1)
    vector = turn * (0.5 * np.sinc(angle / (2.0 * np.pi)))[:, None]
    scalar = np.cos(0.5 * angle)
    wheels = np.zeros((n, 3))
    wheels[:, number % 3] = speed
    house = 20.0 + rng.integers(0, 4096, (n, 8)) / 1024.0
    columns = [*omega.T.round(9), *vector.T.round(10), scalar.round(10), *wheels.T.round(6), *house.T]
    return pa.table([pa.array(c) for c in columns], names=NAMES[1:])


def text(table):
    """Each row as text, without its time."""
    buffer = pa.BufferOutputStream()
    pacsv.write_csv(table, buffer, pacsv.WriteOptions(include_header=False, quoting_style="none"))
    return buffer.getvalue().to_pybytes().decode().splitlines(keepends=True)


def write(path, rows=None, gb=None):
    """Writes so many rows, or slews until the file holds so many gigabytes (1e9 bytes); returns the rows.

    Nine slews are drawn and come again and again, so that 10 GB are written in a few minutes.
    """
    csv = path.endswith(".csv")
    slews = [slew(k) for k in range(min(9, -(-rows // ROWS) if rows else 9))]
    slews = [text(s) for s in slews] if csv else slews
    schema = pa.schema([(name, pa.float64()) for name in NAMES])
    out = open(path, "w") if csv else pq.ParquetWriter(path, schema, compression="none", use_dictionary=False)
    done, number = 0, 0
    with out:
        if csv:
            out.write(",".join(NAMES) + "\n")
        while (done < rows) if rows else (os.path.getsize(path) < gb * 1e9):
            n = min(ROWS, rows - done) if rows else ROWS
            one = slews[number % len(slews)]
            if csv:
                out.write("".join([f"{k * STEP:.3f},{row}" for k, row in zip(range(done, done + n), one)]))
            else:
                times = pa.array(np.round(np.arange(done, done + n) * STEP, 3))
                out.write_table(one.slice(0, n).add_column(0, "time_s", times))
            done += n
            number += 1
    return done


def measure(arguments, log):
    """Runs a command; exit code, peak of the resident memory in MiB, seconds, what it printed."""
    start = time.time()
    with open(log, "w") as out, open(log + ".peak", "w+") as peak:
        # Not from here: a child begins with the memory of this process.
        watched = ["/usr/bin/time", "-f", "%M", "-o", log + ".peak", *arguments]
        code = subprocess.run(watched, stdout=out, stderr=out).returncode
        kib = int(peak.read().split()[-1])
    return code, kib / 1024, time.time() - start, open(log).read()


def table(program, folder, file, rows, questions, show):
    model, log = os.path.join(folder, "m.toml"), os.path.join(folder, "log")
    with open(model, "w") as out:
        out.write(MODEL)
    size = os.path.getsize(file) / 2**20
    for words in questions:
        verb, *more = words.split()
        arguments = [program, verb, *more]
        arguments += ["--model", model, "--telemetry", file] if verb == "identify" else [file]
        code, peak, seconds, said = measure(arguments, log)
        print(f"| `{words}` | {rows:,} | {size:,.0f} | {code} | {peak:.0f} | {seconds:.1f} |", flush=True)
        if show:
            print("\n".join("      " + line for line in said.splitlines()[:show]), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poinsot", default="target/release/poinsot", help="program to use; scripts/bench-memory builds the default")
    parser.add_argument("--write", metavar="FILE", help="write this file and stop")
    parser.add_argument("--keep", metavar="FILE", help="use this file, which --write made, and keep it")
    parser.add_argument("--gb", type=float, help="one file of this size, 1e9 bytes")
    parser.add_argument("--format", choices=["csv", "parquet"], default="csv")
    parser.add_argument("--rows", type=int, nargs="*", default=[20_000, 80_000, 3_000_000])
    parser.add_argument("--folder")
    parser.add_argument("--questions", nargs="*", help="commands, without files")
    parser.add_argument("--show", type=int, default=0, help="lines of each answer to print")
    options = parser.parse_args()
    if options.write:
        print(write(options.write, gb=options.gb or 10.0), "rows")
        return
    program = os.path.abspath(options.poinsot)
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        print("| command | rows | MiB | exit | peak MiB | seconds |\n|---|---|---|---|---|---|")
        file = options.keep or os.path.join(folder, "t." + options.format)
        if options.gb or options.keep:
            rows = write(file, gb=options.gb) if not options.keep else 0
            questions = ["inspect", "identify", "identify --every 997", "identify --time-s 10000,10360 --every 10"]
            table(program, folder, file, rows, options.questions or questions, options.show)
            return
        for rows in options.rows:
            write(file, rows=rows)
            questions = ["inspect"]
            questions += ["identify --method linear", "identify"] if rows <= 100_000 else []
            questions += ["inspect --every 100", "identify --every 100"] if rows > 100_000 else []
            table(program, folder, file, rows, options.questions or questions, options.show)


if __name__ == "__main__":
    main()
