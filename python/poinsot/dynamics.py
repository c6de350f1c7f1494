"""Kernels of free-floating trees of rigid bodies, vectorised over leading axes.

Every function takes the vehicle, then arrays whose last axis is that of one state: `q` and `dq` of shape (..., dof),
the base twist `V` of shape (..., 6). Leading axes are broadcast against each other. Twists, momenta and wrenches have the
**linear part first**: `V = (v_NBo_B, w_NB_B)`, velocity of the base frame's origin and angular velocity of the base, both
in base axes. Momenta are about the base frame's origin, in base axes. Wheels are at rest relative to their hosts.

| here                  | Pinocchio                       | MuJoCo                                                     |
|-----------------------|---------------------------------|------------------------------------------------------------|
| `V`                   | `v[:6]`                         | `qvel[:3]` is `R_NB v_NBo_B`, `qvel[3:6]` is `w_NB_B`      |
| `q` (joints alone)    | `q[7:]`                         | `qpos[7:]`                                                 |
| attitude, scalar last | `q[3:7]`                        | `qpos[3:7]` has the scalar **first**                       |
| ten parameters        | `Inertia.toDynamicParameters()` | `Inertia.from_mujoco(...).to_dynamic_parameters()`         |
| `a_NBo_B`             | `a[:3] + w x v`                 | `R_NB^T qacc[:3]`                                          |
| `alpha_NB_B`          | `a[3:6]`                        | `qacc[3:6]`                                                |
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._errors import InputError
from ._model import Model

Array = NDArray[np.float64]

PARAMETERS: tuple[str, ...] = ("m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz")
"""Names of the ten parameters of a body, about the origin of its frame, in its axes; Pinocchio's order."""

__all__ = [
    "PARAMETERS",
    "Motion",
    "forward_dynamics",
    "integrate",
    "jacobian",
    "mass_matrix",
    "momentum",
    "momentum_regressor",
    "parameter_names",
]


def parameter_names(vehicle: Model) -> tuple[str, ...]:
    """Return the names of the columns of :func:`momentum_regressor`: ``"<body>.<parameter>"``.

    Parameters
    ----------
    vehicle
        The vehicle.

    Examples
    --------
    >>> import poinsot as pn
    >>> pn.dynamics.parameter_names(pn.Model.read("data/stsat3/model.toml"))[:2]
    ('spacecraft.m', 'spacecraft.mc_x')
    """
    return tuple(f"{body}.{name}" for body in vehicle.bodies for name in PARAMETERS)


def _states(**arrays: tuple[Any, int]) -> tuple[list[Array], tuple[int, ...]]:
    """Arrays with equal leading axes as C-contiguous rows, and the leading axes."""
    given: dict[str, Array] = {}
    for name, (values, width) in arrays.items():
        array = np.asarray(values)
        if array.dtype.kind not in "fiub":
            raise InputError(f"E0001 {name}: type {array.dtype} is no real number; give float64")
        if array.ndim == 0 or array.shape[-1] != width:
            raise InputError(f"E0001 {name}: shape {array.shape}, expected (..., {width}); give one entry for each on the last axis")
        given[name] = np.asarray(array, dtype=np.float64)
    try:
        lead = np.broadcast_shapes(*(a.shape[:-1] for a in given.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {a.shape}" for name, a in given.items())
        raise InputError(f"E0001 {shapes}: leading axes do not broadcast; give equal ones") from None
    count = int(np.prod(lead, dtype=np.int64))
    rows = [np.ascontiguousarray(np.broadcast_to(a, (*lead, a.shape[-1]))).reshape(count, a.shape[-1]) for a in given.values()]
    return rows, lead


def _out(out: Array | None, lead: tuple[int, ...], shape: tuple[int, ...]) -> Array:
    """The array to fill, one state a row."""
    count = int(np.prod(lead, dtype=np.int64))
    if out is None:
        return np.empty((count, *shape))
    if out.shape != (*lead, *shape) or out.dtype != np.float64 or not out.flags.c_contiguous or not out.flags.writeable:
        raise InputError(f"E0001 out: shape {out.shape} of {out.dtype}; give a writeable C-contiguous float64 array of shape {(*lead, *shape)}")
    return out.reshape(count, *shape)


def _parameters(vehicle: Model, parameters: ArrayLike | None) -> Array | None:
    if parameters is None:
        return None
    given = np.asarray(parameters, dtype=np.float64)
    expected = (len(vehicle.bodies), 10)
    if given.size != expected[0] * expected[1]:
        raise InputError(f"E0001 parameters: shape {given.shape}, expected {expected}; give ten numbers a body")
    return np.ascontiguousarray(given.reshape(expected))


def momentum_regressor(vehicle: Model, q: ArrayLike, dq: ArrayLike, V: ArrayLike, *, out: Array | None = None) -> Array:
    """Return the momentum regressor: momentum is this matrix times the parameters of all bodies.

    Parameters
    ----------
    vehicle
        The vehicle; its mass properties do not matter.
    q, dq
        Joint positions and rates, rad and rad/s or m and m/s, shape (..., dof).
    V
        Base twist, m/s and rad/s, shape (..., 6).
    out
        Memory for the transpose, shape (..., 10 bodies, 6).

    Returns
    -------
    ndarray, shape (..., 6, 10 bodies)
        Columns in the order of :func:`parameter_names`. A view: its last two axes are those of `out`, exchanged.

    Examples
    --------
    >>> import numpy as np
    >>> import poinsot as pn
    >>> vehicle = pn.Model.read("data/stsat3/model.toml")
    >>> V = np.array([0.0, 0.0, 0.0, 0.1, 0.0, 0.0])
    >>> Y = pn.dynamics.momentum_regressor(vehicle, [], [], V)
    >>> momentum = Y @ vehicle.parameters.ravel()
    >>> bool(np.allclose(momentum, pn.dynamics.momentum(vehicle, [], [], V)))
    True
    """
    dof = len(vehicle.coordinates)
    (first, rates, twist), lead = _states(q=(_joints(q, dof), dof), dq=(_joints(dq, dof), dof), V=(V, 6))
    shape = (10 * len(vehicle.bodies), 6)
    filled = _out(out, lead, shape)
    _core.momentum_regressor(vehicle._core, first, rates, twist, filled)
    return np.swapaxes(filled.reshape(*lead, *shape), -1, -2)


def _joints(values: ArrayLike, dof: int) -> Any:
    """An empty list is no joints, and not an array of no states."""
    array = np.asarray(values)
    return np.empty(0) if dof == 0 and array.size == 0 and array.ndim < 2 else array


def momentum(vehicle: Model, q: ArrayLike, dq: ArrayLike, V: ArrayLike, *, parameters: ArrayLike | None = None) -> Array:
    """Return the momentum of all bodies about the base frame's origin, in base axes.

    Parameters
    ----------
    vehicle, q, dq, V
        As of :func:`momentum_regressor`.
    parameters
        Inertial parameters, shape (bodies, 10); those of the model by default.

    Returns
    -------
    ndarray, shape (..., 6)
        Linear momentum, N s, then angular momentum, N m s.
    """
    dof = len(vehicle.coordinates)
    (first, rates, twist), lead = _states(q=(_joints(q, dof), dof), dq=(_joints(dq, dof), dof), V=(V, 6))
    filled = _out(None, lead, (6,))
    _core.momentum(vehicle._core, first, rates, twist, filled, _parameters(vehicle, parameters))
    return filled.reshape(*lead, 6)


def mass_matrix(vehicle: Model, q: ArrayLike, *, parameters: ArrayLike | None = None) -> Array:
    """Return the mass matrix over the base twist and the joint rates.

    Parameters
    ----------
    vehicle, q, parameters
        As of :func:`momentum`.

    Returns
    -------
    ndarray, shape (..., 6 + dof, 6 + dof)
        ``[momentum about Bo; joint momenta] = M [V; dq]``.
    """
    dof = len(vehicle.coordinates)
    (first,), lead = _states(q=(_joints(q, dof), dof))
    filled = _out(None, lead, (6 + dof, 6 + dof))
    _core.mass_matrix(vehicle._core, first, filled, _parameters(vehicle, parameters))
    return filled.reshape(*lead, 6 + dof, 6 + dof)


def jacobian(
    vehicle: Model,
    body: str | int,
    q: ArrayLike,
    *,
    point_m: ArrayLike = (0.0, 0.0, 0.0),
    generalised: bool = False,
    parameters: ArrayLike | None = None,
) -> Array:
    """Return the Jacobian of a point of a body: its twist, in base axes, over base twist and joint rates.

    Parameters
    ----------
    vehicle, q, parameters
        As of :func:`momentum`.
    body
        Name or index of the body.
    point_m
        The point in the frame of the body, m, shape (3,).
    generalised
        Twist over joint rates alone while the vehicle has no momentum (Umetani and Yoshida 1989).

    Returns
    -------
    ndarray, shape (..., 6, 6 + dof), or (..., 6, dof)
        Linear part first.
    """
    dof = len(vehicle.coordinates)
    index = body if isinstance(body, int) else (vehicle.bodies.index(body) if body in vehicle.bodies else -1)
    if not 0 <= index < len(vehicle.bodies):
        raise InputError(f"E0001 body '{body}': there is no such body; use one of {', '.join(vehicle.bodies)}")
    point = np.asarray(point_m, dtype=np.float64)
    if point.shape != (3,):
        raise InputError(f"E0001 point_m: shape {point.shape}; give (3,)")
    (first,), lead = _states(q=(_joints(q, dof), dof))
    shape = (6, dof if generalised else 6 + dof)
    filled = _out(None, lead, shape)
    if filled.size:
        _core.jacobian(vehicle._core, index, point.tolist(), first, filled, generalised, _parameters(vehicle, parameters))
    return filled.reshape(*lead, *shape)


def forward_dynamics(
    vehicle: Model,
    q: ArrayLike,
    dq: ArrayLike,
    V: ArrayLike,
    tau: ArrayLike,
    *,
    wrench: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    parameters: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """Return accelerations under joint torques in free fall.

    Parameters
    ----------
    vehicle, q, dq, V, parameters
        As of :func:`momentum`.
    tau
        Joint torques or forces, N m or N, shape (..., dof).
    wrench
        Force and torque on the base about its frame's origin, in base axes, N and N m, shape (..., 6).

    Returns
    -------
    acceleration : ndarray, shape (..., 6)
        Inertial acceleration ``a_NBo_B`` of the origin and angular acceleration ``alpha_NB_B``, in base axes. The derivative
        of the components of `v_NBo_B`, which Pinocchio writes, is ``a - w x v``.
    ddq : ndarray, shape (..., dof)
        Joint accelerations.
    """
    dof = len(vehicle.coordinates)
    (first, rates, twist, forces, pushed), lead = _states(
        q=(_joints(q, dof), dof),
        dq=(_joints(dq, dof), dof),
        V=(V, 6),
        tau=(_joints(tau, dof), dof),
        wrench=(wrench, 6),
    )
    filled = _out(None, lead, (6 + dof,))
    _core.forward_dynamics(vehicle._core, first, rates, twist, forces, pushed, filled, _parameters(vehicle, parameters))
    whole = filled.reshape(*lead, 6 + dof)
    return whole[..., :6], whole[..., 6:]


class Motion(NamedTuple):
    """A motion at given times; the second last axis is time.

    Attributes
    ----------
    time_s : ndarray, shape (times,)
    q, dq : ndarray, shape (..., times, dof)
    V : ndarray, shape (..., times, 6)
        Base twist in base axes, linear part first.
    q_xyzw : ndarray, shape (..., times, 4)
        Attitude ``R_NB``, scalar last.
    position_m : ndarray, shape (..., times, 3)
        Position of the base frame's origin in N.
    """

    time_s: Array
    q: Array
    dq: Array
    V: Array
    q_xyzw: Array
    position_m: Array


def integrate(
    vehicle: Model,
    time_s: ArrayLike,
    q: ArrayLike,
    dq: ArrayLike,
    V: ArrayLike,
    tau: ArrayLike | None = None,
    *,
    q_xyzw: ArrayLike = (0.0, 0.0, 0.0, 1.0),
    position_m: ArrayLike = (0.0, 0.0, 0.0),
    parameters: ArrayLike | None = None,
) -> Motion:
    """Integrate the motion in free fall under constant joint torques (Dormand and Prince, eighth order).

    Parameters
    ----------
    vehicle, q, dq, V, parameters
        As of :func:`momentum`: the state at the first time.
    time_s
        Times, s, increasing, shape (times,).
    tau
        Joint torques or forces, N m or N, shape (..., dof); zero by default.
    q_xyzw, position_m
        Attitude and position of the base at the first time, shapes (..., 4) and (..., 3).
    """
    dof = len(vehicle.coordinates)
    times = np.asarray(time_s, dtype=np.float64)
    if times.ndim != 1 or times.size == 0 or not np.all(np.diff(times) > 0.0) or not np.all(np.isfinite(times)):
        raise InputError("E0001 time_s: times must be finite and increasing, shape (times,); correct them")
    rows, lead = _states(
        q=(_joints(q, dof), dof),
        dq=(_joints(dq, dof), dof),
        tau=(np.zeros(dof) if tau is None else _joints(tau, dof), dof),
        V=(V, 6),
        attitude=(q_xyzw, 4),
        position=(position_m, 3),
    )
    first, rates, forces, twist, attitude, position = rows
    start = np.ascontiguousarray(np.concatenate([twist, attitude, position], axis=1))
    filled = _out(None, lead, (times.size, 2 * dof + 13))
    _core.integrate(vehicle._core, times.tolist(), first, rates, start, forces, filled, _parameters(vehicle, parameters))
    whole = filled.reshape(*lead, times.size, 2 * dof + 13)
    parts = np.split(whole, [dof, 2 * dof, 2 * dof + 6, 2 * dof + 10], axis=-1)
    return Motion(times, parts[0], parts[1], parts[2], parts[3], parts[4])
