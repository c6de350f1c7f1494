"""The on-board filter on rows as they arrive."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import Filter as CoreFilter
from ._core import Record as CoreRecord
from ._model import Model
from ._telemetry import _refuse, _times, frame_columns
from ._verbs import as_model

PathLike = str | os.PathLike[str]
Columns = dict[str, NDArray[Any]]

# Rows that are read at once: a second of a fast gyro.
_BATCH = 256


@dataclass(frozen=True)
class FilterAnswer:
    """What the on-board filter knows at one time.

    Attributes
    ----------
    time_s : float
        Time of the record, s.
    health : str
        ``"converging"``: some unknown number has more than half the sigma of its prior. ``"determined"``: all have less, and
        the innovations are those of the declared noise. ``"inconsistent"``: they are not, and no number counts.
        ``"stale"``: there was no sample for long.
    values : dict of str to float
        Mass, kg, mass centre, m, and inertia about it, kg m2, by address, for example ``"bus.inertia_kg_m2.xx"``. NaN until
        the data determine the number, and while the filter is inconsistent.
    sigma : dict of str to float
        One standard deviation of each, in the same unit.
    accepted, gated : dict of str to int
        Measurements of ``"gyro"``, ``"attitude"`` and ``"position"`` that were used, and that were left out because their
        innovation was no noise.
    """

    time_s: float
    health: str
    values: dict[str, float]
    sigma: dict[str, float]
    accepted: dict[str, int]
    gated: dict[str, int]


def _answer(line: str) -> FilterAnswer:
    found = json.loads(line)
    numbers = found["numbers"]
    sensors = {name: found[name] for name in ("gyro", "attitude", "position")}
    return FilterAnswer(
        time_s=found["time_s"],
        health=found["health"],
        values={address: math.nan if n["value"] is None else n["value"] for address, n in numbers.items()},
        sigma={address: n["sigma"] for address, n in numbers.items()},
        accepted={name: counts["accepted"] for name, counts in sensors.items()},
        gated={name: counts["gated"] for name, counts in sensors.items()},
    )


def _columns(rows: Any) -> Columns:
    """Columns of equal length by name, of a mapping or a data frame."""
    if not isinstance(rows, Mapping):
        return frame_columns(rows)[0]
    columns = {str(name): _times(str(name), np.atleast_1d(values)) for name, values in rows.items()}
    if len({values.size for values in columns.values()}) > 1:
        raise _refuse("rows", "columns of several lengths", "give one number per time in each, NaN where there is no sample")
    return columns


class _Stream:
    """The filter of the core, and the last row that it was given: the next batch begins with it, for wheel speeds are interpolated."""

    def __init__(self, vehicle: Model | PathLike, every_s: float, map: PathLike | None) -> None:
        model = as_model(vehicle)
        self.core = CoreFilter((model if map is None else model.with_map(map))._core, every_s)
        self.last: Columns | None = None

    def take(self, columns: Columns) -> list[str]:
        """Lines of the core."""
        if self.last is not None:
            if columns.keys() != self.last.keys():
                raise _refuse("rows", "other columns than before", f"give {', '.join(self.last)}")
            columns = {name: np.concatenate([self.last[name], values]) for name, values in columns.items()}
        count = _length(columns)
        lines = self.core.push(CoreRecord.of_columns("<rows>", list(columns.items()))) if count > 1 else []
        if count > 0:
            self.last = {name: values[-1:].copy() for name, values in columns.items()}
        return lines


def _length(columns: Columns) -> int:
    return next((values.size for values in columns.values()), 0)


class Filter:
    """The recursive filter of flight software on rows as they arrive, as ``poinsot follow`` runs it.

    It estimates one body of a vehicle from a gyro and an attitude with declared noise, wheel speeds, positions and rates of
    joints, and thrust. Mass and mass centre show where joints move, or where thrusters fire and a position is measured. The
    first 300 rows are collected; then numbers come with every row. :func:`poinsot.identify` on the whole record is the reference.

    Parameters
    ----------
    vehicle
        The vehicle, or its model file. One body has unknown numbers; their prior is that of ``[body.prior]``.
    map
        Map or model file with the ``[telemetry]`` table to use.

    Raises
    ------
    InputError
        The filter does not support the vehicle: several unknown bodies, flexible modes, gravity gradient, no declared noise.

    Examples
    --------
    >>> import poinsot as pn
    >>> record = pn.Telemetry.read("data/stsat3/multiaxis/telemetry_noisy.csv")
    >>> time_s, _ = record["omega_x"]
    >>> columns = {"time_s": time_s} | {name: record[name][1] for name in record}
    >>> on_board = pn.Filter("data/stsat3/model.toml")
    >>> for k in range(time_s.size):
    ...     answer = on_board.push({name: values[k] for name, values in columns.items()})
    >>> answer.health, round(answer.values["spacecraft.inertia_kg_m2.xx"], 1)
    ('determined', 13.9)
    """

    __slots__ = ("_stream",)
    _stream: _Stream

    def __init__(self, vehicle: Model | PathLike, *, map: PathLike | None = None) -> None:
        self._stream = _Stream(vehicle, math.inf, map)

    @property
    def assumed(self) -> tuple[str, ...]:
        """What the filter assumes about the vehicle and its priors."""
        return tuple(self._stream.core.assumed)

    def push(self, rows: Any) -> FilterAnswer | None:
        """Take the next row or rows.

        Parameters
        ----------
        rows
            Columns by name as in files, in a mapping or a data frame: one number each for one row, or arrays of shape (n,).
            Each call has the same columns, and its times come after those before.

        Returns
        -------
        FilterAnswer or None
            What is known at the last row; None before the second one.

        Raises
        ------
        InputError
            The rows cannot be read. The filter is as before.
        """
        self._stream.take(_columns(rows))
        return self.answer()

    def answer(self, time_s: float | None = None) -> FilterAnswer | None:
        """Return what is known.

        Parameters
        ----------
        time_s
            Time of the record, s: long after the last row the health is stale. That of the last row by default.
        """
        line = self._stream.core.at(time_s)
        return None if line is None else _answer(line)

    def __repr__(self) -> str:
        known = self.answer()
        return f"<poinsot.Filter: {'no samples' if known is None else known.health}>"


def follow(vehicle: Model | PathLike, rows: Any, *, every_s: float = 1.0, map: PathLike | None = None) -> Iterator[FilterAnswer]:
    """Run the on-board filter over a record, as ``poinsot follow`` does.

    Yields what is known as the rows go by, and at the end.

    Parameters
    ----------
    vehicle, map
        As of :class:`Filter`.
    rows
        The record: a data frame, or a mapping of arrays of shape (n,) by the names of the columns.
    every_s
        Shortest time between two answers, s of the record.

    Yields
    ------
    FilterAnswer

    Examples
    --------
    >>> import poinsot as pn
    >>> record = pn.Telemetry.read("data/stsat3/multiaxis/telemetry_noisy.csv")
    >>> columns = {"time_s": record["omega_x"][0]} | {name: record[name][1] for name in record}
    >>> answers = list(pn.follow("data/stsat3/model.toml", columns, every_s=10.0))
    >>> answers[0].health, answers[-1].health
    ('converging', 'determined')
    """
    return _answers(_Stream(vehicle, every_s, map), _columns(rows))


def _answers(stream: _Stream, columns: Columns) -> Iterator[FilterAnswer]:
    for first in range(0, _length(columns), _BATCH):
        batch = {name: values[first : first + _BATCH] for name, values in columns.items()}
        for line in stream.take(batch):
            yield _answer(line)
    last = stream.core.end()
    if last is not None:
        yield _answer(last)
