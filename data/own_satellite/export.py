#!/usr/bin/env python3
"""Writes two nights of telemetry as a ground station exports them: dates, degrees, rpm, scalar first, semicolons.

The numbers are those of data/stsat3 (six slews, one slew); the tutorial docs/tutorial/own_satellite.md reads the files.

    python3 data/own_satellite/export.py FOLDER
"""

import csv
import math
import sys
from datetime import datetime, timedelta
from pathlib import Path

RECORDS = Path(__file__).resolve().parent.parent / "stsat3"
NIGHTS = {"night1": ("multiaxis", datetime(2026, 3, 14, 18, 19)), "night2": ("paper", datetime(2026, 3, 15, 18, 7))}
RPM = 60 / (2 * math.pi)
TRACKER_EVERY = 5  # rows: a tracker of 2 Hz beside a gyro of 10 Hz


def write(path, rows):
    with open(path, "w", newline="") as file:
        csv.writer(file, delimiter=";", lineterminator="\n").writerows(rows)
    print(f"{path.name}: {len(rows)} lines")


def export(folder, night, record, start):
    with open(RECORDS / record / "telemetry_noisy.csv") as file:
        rows = list(csv.DictReader(file))
    times = [(start + timedelta(seconds=float(row["time_s"]))).isoformat(timespec="milliseconds") for row in rows]
    aocs = [["UTC", "GYR_X", "GYR_Y", "GYR_Z", "RW1", "RW2", "RW3"], ["", *["deg/s"] * 3, *["rpm"] * 3]]
    tracker = [["UTC", "Q0", "Q1", "Q2", "Q3"]]
    for k, (time, row) in enumerate(zip(times, rows)):
        rates = [f"{math.degrees(float(row[f'omega_{axis}'])):.6f}" for axis in "xyz"]
        wheels = [f"{float(row[name]) * RPM:.7f}" for name in ("wheel1_rad_s", "wheel2_rad_s", "wheel3_rad_s")]
        aocs.append([time, *rates, *wheels])
        if k % TRACKER_EVERY == 0:
            # The tracker gives the rotation from inertial to body axes: the vector part changes its sign.
            vector = [f"{-float(row[f'q_{axis}']):.8f}" for axis in "xyz"]
            tracker.append([time, f"{float(row['q_w']):.8f}", *vector])
    write(folder / f"{night}_aocs.csv", aocs)
    write(folder / f"{night}_tracker.csv", tracker)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for night, (record, start) in NIGHTS.items():
        export(folder, night, record, start)


if __name__ == "__main__":
    main()
