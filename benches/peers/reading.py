"""Reads eight of thirty columns with pyarrow and polars, and hashes the file: `reading.py FOLDER [--write ROWS]`.

Prints `name,value,unit`; the fastest of five reads, one thread each. `scripts/bench-read` compares them with ours.
"""
import hashlib
import os
import sys
import time
from pathlib import Path

os.environ["POLARS_MAX_THREADS"] = "1"

import numpy as np
import polars
import pyarrow
import pyarrow.csv
import pyarrow.parquet

READS = 5
USED = ["time_s", "omega_x", "omega_y", "omega_z"] + [f"wheel{k}_rad_s" for k in range(1, 5)]
OTHERS = [f"housekeeping_{k}" for k in range(22)]


def write(folder, rows):
    t = np.arange(rows) * 0.01
    columns = {"time_s": t}
    for k, name in enumerate(USED[1:] + OTHERS):
        columns[name] = np.sin(t * (0.1 + 0.01 * k) + k)
    table = pyarrow.table(columns)
    pyarrow.csv.write_csv(table, folder / "table.csv", pyarrow.csv.WriteOptions(quoting_style="none"))
    pyarrow.parquet.write_table(table, folder / "table.parquet")


def fastest(read):
    best = float("inf")
    for _ in range(READS):
        began = time.perf_counter()
        read()
        best = min(best, time.perf_counter() - began)
    return best


def main():
    folder = Path(sys.argv[1])
    if "--write" in sys.argv:
        write(folder, int(sys.argv[sys.argv.index("--write") + 1]))
        return
    pyarrow.set_cpu_count(1)
    csv, parquet = folder / "table.csv", folder / "table.parquet"
    only = pyarrow.csv.ConvertOptions(include_columns=USED)
    one = pyarrow.csv.ReadOptions(use_threads=False)
    reads = {
        "pyarrow_read_csv": lambda: pyarrow.csv.read_csv(csv, read_options=one, convert_options=only),
        "polars_read_csv": lambda: polars.scan_csv(csv).select(USED).collect(),
        "polars_read_csv_all_columns": lambda: polars.read_csv(csv),
        "hash_csv": lambda: hashlib.sha256(csv.read_bytes()).digest(),
        "pyarrow_read_parquet": lambda: pyarrow.parquet.read_table(parquet, columns=USED, use_threads=False),
        "polars_read_parquet": lambda: polars.read_parquet(parquet, columns=USED),
        "hash_parquet": lambda: hashlib.sha256(parquet.read_bytes()).digest(),
    }
    for name, read in reads.items():
        print(f"{name},{fastest(read):.4f},s")


main()
