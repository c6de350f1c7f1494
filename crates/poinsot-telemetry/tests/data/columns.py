"""Columns of every type that telemetry uses, and of some that it refuses: pip install pyarrow==26.0.0"""

import datetime
import pathlib

import pyarrow as pa
import pyarrow.parquet as pq

FOLDER = pathlib.Path(__file__).parent
START_NS = 1_773_512_340_100_000_000
STEP_NS = 200_000_001


def instants(unit, zone=None):
    per_count = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}[unit]
    counts = [(START_NS + k * STEP_NS) // per_count for k in range(2)]
    return pa.array(counts, pa.timestamp(unit, zone))


def whole(kind, values):
    return pa.array(values, kind)


runs = {
    "group": pa.array(["g"] * 5, pa.large_string()),
    "log": pa.array(["a", "a", "b", "b", "b"]).dictionary_encode().cast(pa.dictionary(pa.int8(), pa.string())),
    "t_ns": whole(pa.int64(), [0, 100_000_000, 0, 100_000_000, 200_000_000]),
    "wx": pa.array([1.0, 2.0, 0.1, float("nan"), 5.0], pa.float32()),
    "wheel1_rad_s": pa.array([None, 1.0, None, 2.0, 3.0], pa.float64()),
    "thr1_N": pa.array([True, False, True, False, True]),
}
pq.write_table(pa.table(runs), FOLDER / "runs.parquet", compression="zstd", row_group_size=2)

types = {
    "ns": instants("ns"),
    "us": instants("us", "UTC"),
    "ms": instants("ms"),
    "int8": whole(pa.int8(), [-128, 127]),
    "int16": whole(pa.int16(), [-32768, 32767]),
    "int32": whole(pa.int32(), [-(2**31), 2**31 - 1]),
    "int64": whole(pa.int64(), [-(2**52), 2**52]),
    "uint8": whole(pa.uint8(), [0, 255]),
    "uint16": whole(pa.uint16(), [0, 65535]),
    "uint32": whole(pa.uint32(), [0, 2**32 - 1]),
    "uint64": whole(pa.uint64(), [0, 2**63]),
    "infinite": pa.array([0.0, float("-inf")], pa.float64()),
    "nothing": pa.nulls(2),
    "text": pa.array(["1", "2"]),
    "bytes": pa.array([b"1", b"2"]),
    "date": pa.array([datetime.date(2026, 3, 14)] * 2),
    "time": pa.array([datetime.time(1), datetime.time(2)], pa.time64("us")),
    "decimal": pa.array([1, 2]).cast(pa.decimal128(30, 2)),
    "half": pa.array([1.0, 2.0], pa.float32()).cast(pa.float16()),
    "list": pa.array([[1.0], [2.0]]),
    "structure": pa.array([{"x": 1.0}, {"x": 2.0}]),
}
pq.write_table(pa.table(types), FOLDER / "types.parquet")
pq.write_table(pa.table({"ns": instants("ns"), "int8": types["int8"]}), FOLDER / "int96.parquet", use_deprecated_int96_timestamps=True)
