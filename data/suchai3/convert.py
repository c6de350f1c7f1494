"""Rates of SUCHAI-3 in orbit, from the tables of its operators to CSV files of one coasting record each.

    git clone https://github.com/spel-uchile/Experimental-Attitude-Dataset source
    python data/suchai3/convert.py source OUT        # needs pandas and openpyxl

A record is the longest run of readings one second apart. The columns that the source calls acc_x, acc_y, acc_z are rates, deg/s.
"""

import sys
from pathlib import Path

import pandas

SOURCES = {
    "20230824": "data/M-20230824/gyros-S3-240823.xlsx",
    "20230904": "data/20230904/gyros-S3-040923.xlsx",
    "20231113": "data/20231113/S3-gyros-13112023.xlsx",
    "20231211": "data/20231211/S3-gyros-11122023.xlsx",
}
NAMES = ["timestamp", "gyro_x", "gyro_y", "gyro_z", "mag_x", "mag_y", "mag_z"]


def record(path):
    """The longest run of a table."""
    table = pandas.read_excel(path).iloc[:, 1:8].set_axis(NAMES, axis=1).dropna()
    table["timestamp"] = table["timestamp"].astype("int64")
    run = (table["timestamp"].diff() != 1).cumsum()
    return table[run == run.value_counts().idxmax()]


def main(source, out):
    Path(out).mkdir(parents=True, exist_ok=True)
    for date, path in SOURCES.items():
        own = record(Path(source) / path)
        own.to_csv(Path(out) / f"suchai3_{date}.csv", index=False, float_format="%.6f", lineterminator="\n")
        print(f"suchai3_{date}.csv: {len(own)} s")


if __name__ == "__main__":
    main(*sys.argv[1:])
