"""A problem for a method of one's own."""

from __future__ import annotations

import os
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._model import Model
from ._telemetry import _vector, as_records
from ._verbs import _options, as_model

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Evaluation:
    """A problem at one value of its unknowns.

    Attributes
    ----------
    residual : ndarray, shape (m,)
        Whitened residuals of all sensors, then those of declared priors.
    jacobian : ndarray, shape (m, n)
        Slopes of `residual` over the unknowns, whitening held.
    information : ndarray, shape (n, n)
        Fisher information, priors included.
    covariance : ndarray, shape (n, n), or None
        Its inverse; None where a combination of the unknowns is undetermined.
    log_likelihood, log_prior : float
        Logarithms of the densities of measurements and priors.
    sensors : list of dict
        By segment and sensor: ``segment``, ``sensor``, ``unit``, ``time_s``, ``raw`` (measured less predicted), ``white``,
        ``first_row`` of it in `residual`.
    """

    residual: Array
    jacobian: Array
    information: Array
    covariance: Array | None
    log_likelihood: float
    log_prior: float
    sensors: list[dict[str, Any]]

    def operator(self) -> Any:
        """Return the Jacobian as a :class:`scipy.sparse.linalg.LinearOperator`."""
        return import_module("scipy.sparse.linalg").aslinearoperator(self.jacobian)


class Problem:
    """Model and records behind the gate of :func:`poinsot.identify`, for an estimator of one's own.

    The unknowns are those of maximum likelihood: pose and momentum at the start of every segment, mass properties,
    biases and other errors of sensors.

    Parameters
    ----------
    vehicle
        The vehicle, or its model file.
    records
        As of :func:`poinsot.identify`.
    **options
        Options of :func:`poinsot.identify` that concern telemetry: `strict`, `policies`, `map`, `time_s`, `every` ...

    Examples
    --------
    >>> import poinsot as pn
    >>> problem = pn.Problem("data/stsat3/model.toml", "data/stsat3/multiaxis/telemetry_noisy.csv", every=10)
    >>> here = problem.evaluate(problem.x0)
    >>> here.jacobian.shape == (here.residual.size, len(problem.names))
    True
    """

    def __init__(self, vehicle: Model | str | os.PathLike[str], records: Any, **options: Any) -> None:
        self._core = _core.Problem(as_model(vehicle)._core, as_records(records), _options(**options))
        self._last: tuple[bytes, Evaluation] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return tuple(self._core.names)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the unknowns."""
        return tuple(self._core.units)

    @property
    def x0(self) -> Array:
        """Values of the model and of the first samples, shape (n,)."""
        return self._core.nominal

    @property
    def repairs(self) -> tuple[str, ...]:
        """What was assumed or repaired."""
        return tuple(self._core.repairs)

    def evaluate(self, theta: ArrayLike) -> Evaluation:
        """Evaluate residuals, Jacobian, information and likelihood.

        Parameters
        ----------
        theta
            Values of the unknowns, shape (n,), in the order of `names`.
        """
        values = np.ascontiguousarray(_vector("theta", theta))
        key = values.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = (key, Evaluation(**self._core.evaluate(values)))
        return self._last[1]

    def residual(self, theta: ArrayLike) -> Array:
        """Return the whitened residuals, shape (m,): the function of :func:`scipy.optimize.least_squares`.

        Parameters
        ----------
        theta
            Values of the unknowns, shape (n,), in the order and units of :attr:`names`.
        """
        return self.evaluate(theta).residual

    def jacobian(self, theta: ArrayLike) -> Array:
        """Return the Jacobian, shape (m, n): the `jac` of :func:`scipy.optimize.least_squares`.

        Parameters
        ----------
        theta
            Values of the unknowns, shape (n,), in the order and units of :attr:`names`.
        """
        return self.evaluate(theta).jacobian

    def __repr__(self) -> str:
        return f"<poinsot.Problem: {len(self.names)} unknowns>"
