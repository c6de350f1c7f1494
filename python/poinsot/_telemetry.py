"""Telemetry of one segment."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import Record as CoreRecord
from ._errors import InputError

PathLike: TypeAlias = str | os.PathLike[str]

# Arrays of three or four components: argument, prefix of the columns, axes.
_VECTORS = {
    "omega_rad_s": ("omega", "xyz"),
    "q_xyzw": ("q", "xyzw"),
    "position_m": ("r", "xyz"),
    "velocity_m_s": ("v", "xyz"),
    "velocity_increment_m_s": ("dv", "xyz"),
    "acceleration_m_s2": ("acc", "xyz"),
    "orbit_m": ("orbit", "xyz"),
}
# Dictionaries of columns by name: argument, suffix of the columns, what is named.
_SCALARS = {
    "joint_rad": ("_rad", "joint"),
    "joint_rad_s": ("_rad_s", "joint"),
    "joint_m": ("_m", "joint"),
    "joint_m_s": ("_m_s", "joint"),
    "wheel_rad_s": ("_rad_s", "wheel"),
    "thruster_N": ("_N", "thruster"),
}


def _refuse(argument: str, what: str, remedy: str, code: str = "E0001") -> InputError:
    return InputError(f"{code} {argument}: {what}; {remedy}")


def _numbers(argument: str, values: Any) -> NDArray[np.float64]:
    """Real numbers as float64, whatever numeric type and layout they have; masked values are NaN."""
    if isinstance(values, np.ma.MaskedArray):
        masked: Any = values
        values = masked.astype(np.float64).filled(np.nan)
    try:
        array = np.asarray(values)
    except (ValueError, TypeError) as error:
        raise _refuse(argument, f"no array ({error})", "give numbers") from None
    if array.dtype.kind == "O":
        try:
            array = np.array([np.nan if x is None else x for x in array.ravel()], dtype=np.float64).reshape(array.shape)
        except (ValueError, TypeError):
            raise _refuse(argument, "an array of objects that are no numbers", "give numbers, NaN where there is no sample") from None
    if array.dtype.kind not in "fiub":
        raise _refuse(argument, f"type {array.dtype} is no real number", "give float64")
    return np.asarray(array, dtype=np.float64)


def _vector(argument: str, values: Any) -> NDArray[np.float64]:
    array = _numbers(argument, values)
    if array.ndim != 1:
        raise _refuse(argument, f"shape {array.shape}", "give one dimension, one number per time")
    return array


def _times(argument: str, values: Any) -> NDArray[Any]:
    """Seconds, or whole nanoseconds since 1970 where the values are dates."""
    array = np.asarray(values)
    if array.dtype.kind == "M" and array.ndim == 1:
        missing = np.flatnonzero(np.isnat(array))
        if missing.size:
            raise _refuse(f"{argument}[{missing[0]}]", "the date is missing (NaT)", "leave the row out", "E0208")
        return array.astype("datetime64[ns]").astype(np.int64)
    return _vector(argument, values)


def _check_times(argument: str, times: NDArray[Any], *, increasing: bool) -> None:
    """Refuse a record without rows, a time that is no number and, where it is asked for, one that is not after the one before it."""
    if times.size == 0:
        raise _refuse(argument, f"shape {times.shape} holds no time", "give at least one row")
    unfit = np.flatnonzero(~np.isfinite(times))
    if unfit.size:
        raise _refuse(f"{argument}[{unfit[0]}]", f"{times[unfit[0]]} is not a time", "correct it or leave the row out", "E0208")
    stays = np.flatnonzero(times[1:] <= times[:-1]) if increasing else unfit
    if stays.size:
        before, here = (_time_as_read(time) for time in times[stays[0] : stays[0] + 2])
        problem = f"{here} does not come after {before} at index {stays[0]}"
        raise _refuse(f"{argument}[{stays[0] + 1}]", problem, "sort the rows and keep one for each time", "E0208")


def _time_as_read(time: Any) -> str:
    """Seconds, or the date of whole nanoseconds."""
    return str(np.datetime64(int(time), "ns")) if isinstance(time, np.integer) else f"{float(time)!r} s"


def _named(argument: str, what: str, values: Any) -> Mapping[str, Any]:
    """A dictionary of arrays, and nothing else."""
    if values is None or isinstance(values, Mapping):
        return values or {}
    also = ", or name the columns by wheels=[...]" if argument.startswith("wheel") else ""
    remedy = f"give a dictionary of arrays by the name of the {what}{also}"
    raise _refuse(argument, f"{type(values).__name__} of shape {np.shape(values)} has no names", remedy)


def _wheels(given: Mapping[str, Any], rows: int) -> tuple[str, Any]:
    """The argument of the wheel speeds that was given, and a dictionary of them, of an array where `wheels` names its columns."""
    if given.get("wheel_rad_s") is not None and given.get("wheel_speeds") is not None:
        raise _refuse("wheel_speeds", "it is another name of wheel_rad_s", "give one of the two")
    argument = "wheel_rad_s" if given.get("wheel_speeds") is None else "wheel_speeds"
    values, wheels = given.get(argument), given.get("wheels")
    if wheels is None:
        return argument, values
    if values is None or isinstance(values, Mapping):
        raise _refuse("wheels", "there is no array whose columns they name", f"leave them out, or give an array as {argument}")
    names = [wheels] if isinstance(wheels, str) else [str(name) for name in wheels]
    if len(set(names)) < len(names):
        raise _refuse("wheels", f"{', '.join(names)} repeat a name", "give each wheel one of its own")
    array = _numbers(argument, values)
    # One wheel may come without an axis for wheels.
    array = array[:, None] if array.ndim == len(names) == 1 else array
    if array.shape != (rows, len(names)):
        raise _refuse(argument, f"shape {array.shape}, expected {(rows, len(names))}", "give one row per time and one column per name in wheels")
    return argument, {name: array[:, k] for k, name in enumerate(names)}


def _table(given: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Columns of a file by the arguments of :meth:`Telemetry.from_arrays`."""
    table: dict[str, NDArray[Any]] = {"time_s": _times("time_s", given.get("time_s"))}
    rows = table["time_s"].size
    prefix = f"{given['sensor']}." if given.get("sensor") else ""
    for argument, (short, axes) in _VECTORS.items():
        if given.get(argument) is None:
            continue
        array = _numbers(argument, given.get(argument))
        if array.shape != (rows, len(axes)):
            raise _refuse(argument, f"shape {array.shape}, expected {(rows, len(axes))}", "give one row per time")
        table.update({f"{prefix}{short}_{axis}": array[:, k] for k, axis in enumerate(axes)})
    for argument, (suffix, what) in _SCALARS.items():
        shown, values = _wheels(given, rows) if what == "wheel" else (argument, given.get(argument))
        for name, column in _named(shown, what, values).items():
            table[f"{name}{suffix}"] = _column(f"{shown}[{name!r}]", column, rows)
    for name, column in _named("columns", "column", given.get("columns")).items():
        table[name] = _column(f"columns[{name!r}]", column, rows)
    return table


def _column(argument: str, values: Any, rows: int) -> NDArray[np.float64]:
    array = _vector(argument, values)
    if array.size != rows:
        raise _refuse(argument, f"{array.size} values for {rows} times", "give one per time, NaN where there is no sample")
    return array


def _frame_column(name: str, column: Any) -> NDArray[Any] | None:
    """A column of a data frame as an array; None where it holds neither numbers nor dates."""
    array = np.asarray(column.to_numpy())
    if array.dtype.kind == "M":
        return _times(name, array)
    if array.dtype.kind == "O":
        # Missing entries of pandas (pd.NA) and polars (None) among numbers.
        try:
            array = np.array([np.nan if _missing(x) else float(x) for x in array], dtype=np.float64)
        except (ValueError, TypeError):
            return None
    return array.astype(np.float64) if array.dtype.kind in "fiub" else None


def frame_columns(frame: Any) -> tuple[dict[str, NDArray[Any]], type]:
    """Columns of a data frame that hold numbers or dates, and the type that they were read from."""
    if not (hasattr(frame, "columns") and hasattr(frame, "__getitem__") and not hasattr(frame, "column_names")):
        if not hasattr(frame, "__arrow_c_stream__"):
            kind = type(frame).__name__
            raise _refuse("frame", f"{kind} is no data frame", "give pandas, polars or an Arrow stream")
        try:
            pyarrow: Any = import_module("pyarrow")
        except ImportError:
            raise _refuse("frame", "an Arrow stream is read by pyarrow, which is missing", "pip install 'poinsot[frames]'") from None
        frame = pyarrow.table(frame)
    names: Sequence[str] = list(frame.column_names if hasattr(frame, "column_names") else frame.columns)
    table = {str(column): _frame_column(str(column), frame[column]) for column in names}
    return {column: values for column, values in table.items() if values is not None}, type(frame)


def _missing(x: Any) -> bool:
    return x is None or type(x).__name__ in ("NAType", "NaTType")


def of_log(name: str, **arrays: Any) -> Telemetry:
    """A record of what a program logged, by the arguments of `from_arrays`; rows of one time are joined, as those of a file."""
    table = _table(arrays)
    _check_times("time_s", table["time_s"], increasing=False)
    return Telemetry._of_table(table, name)


class Telemetry:
    """Telemetry of one segment: files, arrays, or several of both with time bases of their own.

    Names of columns are those of the command, for example ``omega_x``, ``joint1_rad``, ``wheel1_rad_s``; those that are
    not are mapped by the ``[telemetry]`` table of the model. Files are opened when the record is used. Use :meth:`read`,
    :meth:`from_arrays`, :meth:`from_frame`, :meth:`from_bytes` or :meth:`join`; a call of the class is a TypeError.

    Examples
    --------
    >>> import numpy as np
    >>> import poinsot as pn
    >>> record = pn.Telemetry.read("data/stsat3/multiaxis/telemetry_noisy.csv")
    >>> time_s, rate = record["omega_x"]
    >>> same = pn.Telemetry.from_arrays(time_s=time_s, omega_rad_s=np.column_stack([record[f"omega_{a}"][1] for a in "xyz"]))
    >>> sorted(same)
    ['omega_x', 'omega_y', 'omega_z']
    """

    __slots__ = ("_channels", "_core")
    _core: CoreRecord
    _channels: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]] | None

    def __init__(self, *arguments: object, **options: object) -> None:
        raise TypeError(
            "Telemetry is not called directly; use Telemetry.read(path), Telemetry.from_frame(frame), "
            "Telemetry.from_arrays(time_s=..., omega_rad_s=...), Telemetry.from_bytes(content) or Telemetry.join(record, ...)"
        )

    @classmethod
    def _of(cls, core: CoreRecord) -> Telemetry:
        made = cls.__new__(cls)
        made._core = core
        made._channels = None
        return made

    @classmethod
    def read(cls, *paths: PathLike) -> Telemetry:
        """Read the files of one segment (CSV, CSV packed by gzip or Zstandard, Parquet).

        Parameters
        ----------
        *paths
            Files; each keeps its own time base.
        """
        if not paths:
            raise _refuse("paths", "no file", "give at least one")
        return cls._of(CoreRecord.of_files([os.fspath(p) for p in paths]))

    @classmethod
    def from_bytes(cls, content: bytes, *, name: str = "<bytes>") -> Telemetry:
        """Read the bytes of one file (CSV, packed or not, or Parquet), with the same result as from the file.

        Parameters
        ----------
        content
            Bytes of the file.
        name
            What messages call them; a ``[[telemetry.file]]`` of the map chooses by it.
        """
        return cls._of(CoreRecord.of_bytes(name, content))

    @classmethod
    def from_arrays(
        cls,
        *,
        time_s: ArrayLike,
        omega_rad_s: ArrayLike | None = None,
        q_xyzw: ArrayLike | None = None,
        position_m: ArrayLike | None = None,
        velocity_m_s: ArrayLike | None = None,
        velocity_increment_m_s: ArrayLike | None = None,
        acceleration_m_s2: ArrayLike | None = None,
        orbit_m: ArrayLike | None = None,
        joint_rad: Mapping[str, ArrayLike] | None = None,
        joint_rad_s: Mapping[str, ArrayLike] | None = None,
        joint_m: Mapping[str, ArrayLike] | None = None,
        joint_m_s: Mapping[str, ArrayLike] | None = None,
        wheel_rad_s: Mapping[str, ArrayLike] | ArrayLike | None = None,
        wheel_speeds: Mapping[str, ArrayLike] | ArrayLike | None = None,
        wheels: Sequence[str] | None = None,
        thruster_N: Mapping[str, ArrayLike] | None = None,
        columns: Mapping[str, ArrayLike] | None = None,
        sensor: str = "",
        name: str = "<arrays>",
    ) -> Telemetry:
        """Make a record of arrays with one time base; NaN where there is no sample.

        Parameters
        ----------
        time_s
            Times, s, shape (n,), strictly increasing; or dates (datetime64).
        omega_rad_s
            Angular velocity of the base in its axes, rad/s, shape (n, 3).
        q_xyzw
            Attitude of the base, Hamilton, scalar last, body to inertial, shape (n, 4).
        position_m, velocity_m_s, velocity_increment_m_s
            Of the base frame's origin or the sensor point, inertial axes, shape (n, 3).
        acceleration_m_s2
            Specific force at the sensor point, body axes, shape (n, 3).
        orbit_m
            Position of the reference orbit from the attracting body, inertial axes, shape (n, 3).
        joint_rad, joint_rad_s, joint_m, joint_m_s, thruster_N
            Arrays of shape (n,) by the name of the joint or thruster.
        wheel_rad_s
            Arrays of shape (n,) by the name of the wheel; or one array of shape (n, wheels), with `wheels`.
        wheel_speeds
            Another name of `wheel_rad_s`.
        wheels
            Names of the columns of `wheel_rad_s` where it is one array, in their order.
        columns
            Any other columns by their names in the file format, shape (n,).
        sensor
            Name of the sensor that `omega_rad_s`, `q_xyzw` and the other vectors belong to, where there are several.
        name
            What messages call the record.

        Returns
        -------
        Telemetry
            Use :meth:`join` to add arrays with another time base.

        Raises
        ------
        InputError
            A shape is wrong, an array has no names, or a time is missing or does not come after the one before it. The message
            names the argument and the index.

        Examples
        --------
        >>> import numpy as np
        >>> import poinsot as pn
        >>> time_s = np.linspace(0.0, 9.9, 100)
        >>> speeds = np.zeros((100, 2))
        >>> sorted(pn.Telemetry.from_arrays(time_s=time_s, wheel_rad_s=speeds, wheels=["wheel1", "wheel2"]))
        ['wheel1_rad_s', 'wheel2_rad_s']
        """
        table = _table(locals())
        _check_times("time_s", table["time_s"], increasing=True)
        return cls._of_table(table, name)

    @classmethod
    def _of_table(cls, table: Mapping[str, NDArray[Any]], name: str) -> Telemetry:
        if not name.startswith("<"):
            name = f"<{name}>"
        return cls._of(CoreRecord.of_columns(name, list(table.items())))

    @classmethod
    def from_frame(cls, frame: Any, *, name: str | None = None) -> Telemetry:
        """Make a record of a data frame: pandas, polars, or anything with ``__arrow_c_stream__``.

        Columns are named as in the files; columns that hold neither numbers nor dates are left out. The order of the rows is
        that of a file: rows of one time are joined, and times that go back are refused when the record is used.

        Parameters
        ----------
        frame
            The data frame. Arrow streams of other libraries are read by pyarrow.
        name
            What messages call the record.
        """
        columns, of = frame_columns(frame)
        if "time_s" in columns:
            _check_times("time_s", columns["time_s"], increasing=False)
        return cls._of_table(columns, name or f"<{of.__module__.split('.')[0]}.{of.__name__}>")

    @classmethod
    def join(cls, *records: Telemetry) -> Telemetry:
        """Return one segment of several records.

        Parameters
        ----------
        *records
            Each keeps its own time base.
        """
        if not records:
            raise _refuse("records", "no record", "give at least one")
        return cls._of(CoreRecord.join([r._core for r in records]))

    @property
    def sources(self) -> tuple[str, ...]:
        """Files, and names of what is in memory."""
        return tuple(self._core.names)

    def to_dict(self) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Return the channels with standard names: times, s, and values in SI."""
        if self._channels is None:
            self._channels = self._core.channels()
        return dict(self._channels)

    def __getitem__(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        channels = self.to_dict()
        if name not in channels:
            raise KeyError(f"{name!r}; there are {', '.join(channels)}")
        return channels[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.to_dict())

    def __len__(self) -> int:
        return len(self.to_dict())

    def __contains__(self, name: object) -> bool:
        return name in self.to_dict()

    def __repr__(self) -> str:
        return f"<poinsot.Telemetry of {', '.join(self.sources)}>"


def as_records(records: Any) -> list[Any]:
    """One record, file or frame, or a sequence of them, as the core takes them: one per segment."""
    if isinstance(records, (Telemetry, str, os.PathLike)) or hasattr(records, "__arrow_c_stream__") or hasattr(records, "columns"):
        records = [records]
    out: list[Any] = []
    for record in records:
        if isinstance(record, (str, os.PathLike)):
            record = Telemetry.read(record)
        elif not isinstance(record, Telemetry):
            record = Telemetry.from_frame(record)
        out.append(record._core)
    if not out:
        raise _refuse("records", "no telemetry", "give at least one record")
    return out
