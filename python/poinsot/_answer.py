"""The answer of `identify`."""

from __future__ import annotations

import html
import json
import os
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._errors import InputError, data_frame, write_text

Array = NDArray[np.float64]
PathLike = str | os.PathLike[str]

# Units of the numbers of a body by the quantity that begins their address.
_UNITS = {"mass_kg": "kg", "com_m": "m", "inertia_kg_m2": "kg m2"}
_COLUMNS = ("body", "number", "value", "sigma", "unit", "nominal", "source")
_ELEMENTS = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


def _float(value: float | None) -> float:
    return float("nan") if value is None else float(value)


def _tensor(quantity: Mapping[str, Any], part: str) -> Array:
    out = np.full((3, 3), np.nan)
    for name, (i, j) in _ELEMENTS.items():
        out[i, j] = out[j, i] = _float(quantity[name][part])
    return out


def _vector(quantity: Mapping[str, Any], part: str) -> Array:
    return np.array([_float(quantity[axis][part]) for axis in "xyz"])


def _list(values: Any) -> Array:
    return np.array([_float(x) for x in values])


@dataclass(frozen=True)
class Body:
    """Mass properties of one body; NaN where the data do not determine a number.

    Attributes
    ----------
    name : str
        Name of the body.
    mass_kg, mass_sigma_kg : float
        Mass and its standard deviation.
    com_m, com_sigma_m : ndarray, shape (3,)
        Mass centre from the origin of the body's frame, in its axes.
    inertia_kg_m2, inertia_sigma_kg_m2 : ndarray, shape (3, 3)
        Inertia tensor about the mass centre, tensor elements, in the body's axes.
    source : dict
        Origin of every number by address, ``"mass_kg"``, ``"com_m.x"`` ..., ``"inertia_kg_m2.xx"`` ...: ``"data"``,
        ``"prior"``, ``"known"``, or None where it is undetermined.
    nominal : dict
        Numbers of the model by the same addresses.
    first_moment_kg_m, first_moment_sigma_kg_m : ndarray, shape (3,)
        Mass times mass centre; may be determined where the mass centre is not.
    inertia_origin_kg_m2, inertia_origin_sigma_kg_m2 : ndarray, shape (3, 3)
        Inertia about the origin of the body's frame.
    principal_moments_kg_m2 : ndarray, shape (3,)
        Ascending; NaN where the tensor is undetermined.
    principal_axes_xyzw : ndarray, shape (4,)
        Rotation from principal to body axes.
    physically_consistent : bool or None
        Whether a distribution of positive mass has this tensor; None where it is undetermined.
    """

    name: str
    mass_kg: float
    mass_sigma_kg: float
    com_m: Array
    com_sigma_m: Array
    inertia_kg_m2: Array
    inertia_sigma_kg_m2: Array
    source: dict[str, str | None]
    nominal: dict[str, float]
    first_moment_kg_m: Array
    first_moment_sigma_kg_m: Array
    inertia_origin_kg_m2: Array
    inertia_origin_sigma_kg_m2: Array
    principal_moments_kg_m2: Array
    principal_axes_xyzw: Array
    physically_consistent: bool | None

    @classmethod
    def _of(cls, name: str, d: Mapping[str, Any]) -> Body:
        mass, com, tensor, about = d["mass_kg"], d["com_m"], d["inertia_kg_m2"], d["barycentric"]
        first, origin, principal = about["mc_kg_m"], about["I_BBo_kg_m2"], d["principal"]
        numbers = {"mass_kg": mass}
        numbers |= {f"com_m.{axis}": com[axis] for axis in "xyz"}
        numbers |= {f"inertia_kg_m2.{element}": tensor[element] for element in _ELEMENTS}
        return cls(
            name=name,
            mass_kg=_float(mass["value"]),
            mass_sigma_kg=_float(mass["sigma"]),
            com_m=_vector(com, "value"),
            com_sigma_m=_vector(com, "sigma"),
            inertia_kg_m2=_tensor(tensor, "value"),
            inertia_sigma_kg_m2=_tensor(tensor, "sigma"),
            source={name: number["source"] for name, number in numbers.items()},
            nominal={name: _float(number["nominal"]) for name, number in numbers.items()},
            first_moment_kg_m=_vector(first, "value"),
            first_moment_sigma_kg_m=_vector(first, "sigma"),
            inertia_origin_kg_m2=_tensor(origin, "value"),
            inertia_origin_sigma_kg_m2=_tensor(origin, "sigma"),
            principal_moments_kg_m2=_list(principal["moments_kg_m2"] if principal else [None] * 3),
            principal_axes_xyzw=_list(principal["axes_xyzw"] if principal else [None] * 4),
            physically_consistent=d["physically_consistent"],
        )

    @property
    def determined(self) -> bool:
        """Whether every number has a value."""
        return all(source is not None for source in self.source.values())

    def to_dataframe(self) -> Any:
        """Return the numbers as a data frame of pandas (``pip install 'poinsot[frames]'``), one row each.

        Returns
        -------
        pandas.DataFrame
            Columns ``body``, ``number`` (address, as in `source`), ``value``, ``sigma``, ``unit``, ``nominal`` and ``source``:
            ``"data"``, ``"prior"``, ``"known"``, or ``"undetermined"``, where value and sigma are NaN.

        Examples
        --------
        >>> import poinsot as pn
        >>> answer = pn.identify("data/stsat3/model.toml", "data/stsat3/multiaxis/telemetry_noisy.csv")
        >>> frame = answer.bodies["spacecraft"].to_dataframe().set_index("number")
        >>> frame.source["mass_kg"], frame.unit["inertia_kg_m2.xx"]
        ('known', 'kg m2')
        """
        return data_frame(self._rows(), _COLUMNS)

    def _rows(self) -> list[tuple[Any, ...]]:
        """Rows of a data frame with `_COLUMNS`."""
        values = {"mass_kg": self.mass_kg, "com_m": self.com_m, "inertia_kg_m2": self.inertia_kg_m2}
        sigmas = {"mass_kg": self.mass_sigma_kg, "com_m": self.com_sigma_m, "inertia_kg_m2": self.inertia_sigma_kg_m2}
        rows: list[tuple[Any, ...]] = []
        for address, source in self.source.items():
            quantity, _, part = address.partition(".")
            # The mass has no components.
            at = _ELEMENTS[part] if part in _ELEMENTS else tuple("xyz".index(axis) for axis in part)
            value, sigma = (float(np.asarray(of[quantity])[at]) for of in (values, sigmas))
            rows.append((self.name, address, value, sigma, _UNITS[quantity], self.nominal[address], source or "undetermined"))
        return rows


@dataclass(frozen=True)
class Covariance:
    """Covariance of all determined numbers.

    Attributes
    ----------
    names : tuple of str
        Addresses of the rows, for example ``"bus.com_m.x"``, ``"gyro.bias_rad_s.x"``.
    units : tuple of str
        Their units.
    matrix : ndarray, shape (n, n)
        The covariance.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    matrix: Array

    @property
    def sigma(self) -> Array:
        """Standard deviations, shape (n,)."""
        return np.sqrt(np.diag(self.matrix)) if len(self.names) else np.zeros(0)


@dataclass(frozen=True)
class Direction:
    """A combination of parameters that the data do not determine.

    Attributes
    ----------
    text : str
        In words.
    coefficients : dict
        Coefficient of each parameter by name.
    reason : str
        Why it is undetermined.
    remedy : str
        What would determine it.
    """

    text: str
    coefficients: dict[str, float]
    reason: str
    remedy: str


@dataclass(frozen=True)
class Residuals:
    """Measured and predicted samples of one sensor in one segment; long records keep every n-th sample.

    Attributes
    ----------
    segment, sensor : str
        Where they belong.
    unit, residual_unit : str
        Units; an attitude is measured as a quaternion, and its residual is a small rotation in body axes, rad.
    components : tuple of str
        Columns of `measured` and `predicted`.
    samples : int
        Samples in the record.
    time_s : ndarray, shape (n,)
        Times of the samples kept.
    measured, predicted : ndarray, shape (n, components)
        Values.
    residual : ndarray, shape (n, 3)
        Measured less predicted.
    """

    segment: str
    sensor: str
    unit: str
    residual_unit: str
    components: tuple[str, ...]
    samples: int
    time_s: Array
    measured: Array
    predicted: Array
    residual: Array

    def to_dataframe(self) -> Any:
        """Return the samples as a data frame of pandas (``pip install 'poinsot[frames]'``), one row for each time.

        Returns
        -------
        pandas.DataFrame
            Columns ``segment``, ``sensor``, ``time_s``, then ``measured_`` and ``predicted_`` with the name of each component,
            in `unit`, and ``residual_x``, ``residual_y``, ``residual_z``, in `residual_unit`.

        Examples
        --------
        >>> import poinsot as pn
        >>> answer = pn.identify("data/stsat3/model.toml", "data/stsat3/multiaxis/telemetry_noisy.csv")
        >>> frame = answer.residuals("gyro").to_dataframe()
        >>> difference = frame.measured_omega_x - frame.predicted_omega_x
        >>> bool((difference - frame.residual_x).abs().max() < 1e-15)
        True
        """
        columns: dict[str, Any] = {"segment": self.segment, "sensor": self.sensor, "time_s": self.time_s}
        for kind, values in (("measured", self.measured), ("predicted", self.predicted)):
            columns |= {f"{kind}_{name}": values[:, k] for k, name in enumerate(self.components)}
        return data_frame(columns | {f"residual_{axis}": self.residual[:, k] for k, axis in enumerate("xyz")})


class Answer:
    """What `identify` found. Nothing undetermined has a number: it is NaN, and `undetermined` says why.

    Attributes
    ----------
    bodies : dict of Body
        Mass properties by the name of the body, in the order of the model.
    """

    def __init__(self, core: _core.Answer) -> None:
        self._core = core
        self._text = core.json()
        self._document: dict[str, Any] = json.loads(self._text)
        self.bodies: dict[str, Body] = {n: Body._of(n, b) for n, b in self._document["bodies"].items()}

    @property
    def status(self) -> str:
        """``converged``, ``partial``, ``not_identifiable``, ``iteration_limit`` or ``rejected``."""
        return str(self._document["status"])

    @property
    def method(self) -> str:
        """Method that answered."""
        return str(self._document["method"])

    @property
    def exit_code(self) -> int:
        """Exit code of the command: 0 where all is determined and every check passed, else 1."""
        return self._core.exit_code

    @property
    def acceptable(self) -> bool:
        """Whether every requested parameter is identified and every check passed."""
        return self.exit_code == 0

    @property
    def evidence(self) -> tuple[str, ...]:
        """Evidence against relying on the answer, most important first; empty where there is none."""
        return tuple(str(e) if not isinstance(e, dict) else str(e.get("text", e)) for e in self._document["doubts"])

    @property
    def sensitivities(self) -> dict[str, float]:
        """How far an assumption moves the answer, in sigma, by the name of the assumption.

        ``"wheel motion between samples"``: torque constant against speed smooth. Empty where the method does not test its
        assumptions, or there is no wheel.
        """
        wheels = self._core.wheel_sensitivity
        return {} if wheels is None else {"wheel motion between samples": wheels}

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings."""
        return tuple(self._document["warnings"])

    @property
    def repairs(self) -> tuple[str, ...]:
        """What was assumed or repaired."""
        return tuple(self._document["repairs"])

    @property
    def covariance(self) -> Covariance:
        """Covariance of all determined numbers."""
        c = self._document["covariance"]
        n = len(c["names"])
        matrix = np.array([[_float(x) for x in row] for row in c["matrix"]]).reshape(n, n)
        return Covariance(tuple(c["names"]), tuple(c["units"]), matrix)

    @property
    def undetermined(self) -> tuple[Direction, ...]:
        """Directions of the parameters that the data do not determine."""
        found = self._document["identifiability"]["not_identifiable"]
        return tuple(Direction(d["combination"], dict(d["coefficients"]), d["reason"], d["remedy"]) for d in found)

    @property
    def rank(self) -> tuple[int, int]:
        """Directions determined, and unknown mass properties."""
        found = self._document["identifiability"]
        return int(found["rank"]), int(found["parameters"])

    @property
    def nuisance(self) -> dict[str, dict[str, Any]]:
        """Biases, scales, lags and spin inertias: value, sigma, nominal, source by address, ``"gyro.bias_rad_s.x"``."""
        return dict(self._document["nuisance"])

    @property
    def predictions(self) -> tuple[Residuals, ...]:
        """Residuals of every sensor in every segment."""
        return tuple(
            Residuals(
                segment=p["segment"],
                sensor=p["sensor"],
                unit=p["unit"],
                residual_unit=p["residual_unit"],
                components=tuple(p["components"]),
                samples=p["samples"],
                time_s=p["time_s"],
                measured=p["measured"].T,
                predicted=p["predicted"].T,
                residual=p["residual"].T,
            )
            for p in self._core.predictions()
        )

    def residuals(self, sensor: str, segment: int = 0) -> Residuals:
        """Return measured, predicted and residual samples of a sensor.

        Parameters
        ----------
        sensor
            Kind, for example ``"gyro"``, or ``"gyro.<name>"`` where several sensors share the kind.
        segment
            Index of the segment.
        """
        found = [r for r in self.predictions if r.sensor == sensor]
        if not 0 <= segment < len(found):
            names = ", ".join(dict.fromkeys(r.sensor for r in self.predictions)) or "none"
            raise InputError(f"E0001 sensor '{sensor}': segment {segment} has no such residuals; use one of {names}")
        return found[segment]

    def to_dataframe(self) -> Any:
        """Return the numbers of all bodies as a data frame of pandas (``pip install 'poinsot[frames]'``), one row each.

        Returns
        -------
        pandas.DataFrame
            Columns of :meth:`Body.to_dataframe`, bodies in the order of the model.

        Examples
        --------
        >>> import poinsot as pn
        >>> answer = pn.identify("data/stsat3/model.toml", "data/stsat3/multiaxis/telemetry_noisy.csv")
        >>> frame = answer.to_dataframe()
        >>> print(frame.loc[frame.source == "data", ["body", "number", "value", "nominal"]].round(2).to_string(index=False))
              body           number  value  nominal
        spacecraft inertia_kg_m2.xx  13.92     15.0
        spacecraft inertia_kg_m2.yy  16.95     16.0
        spacecraft inertia_kg_m2.zz  19.89     21.0
        spacecraft inertia_kg_m2.xy   0.08      0.0
        spacecraft inertia_kg_m2.xz   0.13      0.0
        spacecraft inertia_kg_m2.yz   0.59      0.0
        """
        return data_frame([row for body in self.bodies.values() for row in body._rows()], _COLUMNS)

    def to_dict(self) -> dict[str, Any]:
        """Return ``estimate.json`` as a dictionary; null is None."""
        return dict(json.loads(self._text))

    def to_json(self, path: PathLike | None = None) -> str:
        """Return the text of ``estimate.json``, byte by byte as the command writes it.

        Parameters
        ----------
        path
            File to write.
        """
        if path is not None:
            write_text(path, self._text)
        return self._text

    def write(self, folder: PathLike, *, report: bool = False, figures: tuple[str, ...] = ()) -> list[str]:
        """Write the files of ``poinsot identify --out``; return their paths.

        Parameters
        ----------
        folder
            Made if it is not there.
        report
            Also write ``report.html``.
        figures
            Formats of the figures of the report: ``"svg"``. ``"png"`` needs a build with the feature ``png``.
        """
        return [str(p) for p in self._core.write(folder, report, list(figures))]

    def report(self, path: PathLike | None = None) -> str:
        """Return the report, one HTML page that needs no network.

        Parameters
        ----------
        path
            File to write.
        """
        page = self._core.html()
        if path is not None:
            write_text(path, page)
        return page

    def export(
        self,
        to: str,
        path: PathLike | None = None,
        *,
        onto: PathLike | None = None,
        accept_unreliable: bool = False,
    ) -> str:
        """Write the numbers into the file of another program.

        Parameters
        ----------
        to
            ``"model"``, ``"urdf"``, ``"sdf"``, ``"mjcf"`` (changed in place, need `onto`), ``"basilisk"``, ``"apm"``,
            ``"acm"``, ``"csv"`` or ``"onboard"``.
        path
            File to write.
        onto
            The file that the vehicle came from; nothing but mass properties changes.
        accept_unreliable
            Export numbers that are not reliable too; the file says why they are not.

        Returns
        -------
        str
            The text of the file. Bodies that are not fully determined keep their numbers; a warning names them.
        """
        text, left_out = self._core.export(to, onto, accept_unreliable)
        for line in left_out:
            warnings.warn(line, stacklevel=2)
        if path is not None:
            write_text(path, text)
        return text

    def plot(self, kind: str = "all", **options: Any) -> Any:
        """Draw the answer with matplotlib; see :mod:`poinsot.plot`.

        Parameters
        ----------
        kind
            ``"tensor"``, ``"ellipsoid"``, ``"residuals"``, ``"undetermined"`` or ``"all"``.
        **options
            Passed to the function of that name in :mod:`poinsot.plot`.

        Returns
        -------
        matplotlib.figure.Figure
        """
        from . import plot

        return plot.draw(self, kind, **options)

    def __repr__(self) -> str:
        rank, asked = self.rank
        return f"<poinsot.Answer {self._document['model']!r}: {self.status}, {rank} of {asked} combinations, {self.method}>"

    def __str__(self) -> str:
        return self._core.text()

    def _repr_html_(self) -> str:
        page = html.escape(self.report(), quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 40em; border: 1px solid #ccc"></iframe>'
