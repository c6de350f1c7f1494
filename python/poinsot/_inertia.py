"""Mass properties of one rigid body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError

Array = NDArray[np.float64]

# Relative to the largest moment: printed tables of slender bodies break the triangle inequality by rounding.
_TOLERANCE = 1e-12


def rotation_matrix(wxyz: ArrayLike) -> Array:
    """Rotation of a unit quaternion with the scalar first."""
    w, x, y, z = np.asarray(wxyz, dtype=np.float64)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + 2.0 * (w * cross + cross @ cross))


@dataclass(frozen=True)
class Inertia:
    """Mass, mass centre and central inertia of a rigid body.

    Parameters
    ----------
    mass_kg
        Mass, kg.
    com_m
        Mass centre from the origin of the body's frame, in its axes, m, shape (3,).
    inertia_kg_m2
        Inertia tensor about the mass centre, tensor elements (``I_xy = -integral x y dm``), kg m2, shape (3, 3).

    Examples
    --------
    >>> import poinsot as pn
    >>> box = pn.Inertia(12.0, [0.1, 0, 0], [[1, 0, 0], [0, 2, 0], [0, 0, 2.5]])
    >>> box.is_physical
    True
    >>> bool(abs(pn.Inertia.from_dynamic_parameters(box.to_dynamic_parameters()).inertia_kg_m2 - box.inertia_kg_m2).max() < 1e-15)
    True
    """

    mass_kg: float
    com_m: Array
    inertia_kg_m2: Array

    def __init__(self, mass_kg: float, com_m: ArrayLike, inertia_kg_m2: ArrayLike) -> None:
        com = np.array(com_m, dtype=np.float64)
        tensor = np.array(inertia_kg_m2, dtype=np.float64)
        if com.shape != (3,) or tensor.shape != (3, 3):
            raise InputError(f"E0001 Inertia: shapes {com.shape} and {tensor.shape}; give (3,) and (3, 3)")
        if not np.allclose(tensor, tensor.T, rtol=1e-9, atol=0.0):
            raise InputError("E0001 inertia_kg_m2: the tensor is not symmetric; give tensor elements")
        object.__setattr__(self, "mass_kg", float(mass_kg))
        object.__setattr__(self, "com_m", com)
        object.__setattr__(self, "inertia_kg_m2", 0.5 * (tensor + tensor.T))

    @property
    def inertia_origin_kg_m2(self) -> Array:
        """Inertia about the origin of the body's frame, shape (3, 3)."""
        c = self.com_m
        return self.inertia_kg_m2 + self.mass_kg * (c @ c * np.eye(3) - np.outer(c, c))

    def to_dynamic_parameters(self) -> Array:
        """Return the ten parameters about the origin of the body's frame, in the order of Pinocchio, shape (10,).

        m, mc_x, mc_y, mc_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz.
        """
        i = self.inertia_origin_kg_m2
        tensor = [i[0, 0], i[0, 1], i[1, 1], i[0, 2], i[1, 2], i[2, 2]]
        return np.array([self.mass_kg, *(self.mass_kg * self.com_m), *tensor])

    @classmethod
    def from_dynamic_parameters(cls, parameters: ArrayLike) -> Inertia:
        """Make the body of its ten parameters; the inverse of :meth:`to_dynamic_parameters`.

        Parameters
        ----------
        parameters
            Shape (10,): m, mc_x, mc_y, mc_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the origin of the body's frame; kg, kg m,
            kg m2.
        """
        p = np.array(parameters, dtype=np.float64)
        if p.shape != (10,) or not p[0] > 0.0:
            raise InputError(f"E0001 parameters: shape {p.shape} or a mass that is not positive; give ten numbers")
        c = p[1:4] / p[0]
        about = np.array([[p[4], p[5], p[7]], [p[5], p[6], p[8]], [p[7], p[8], p[9]]])
        return cls(p[0], c, about - p[0] * (c @ c * np.eye(3) - np.outer(c, c)))

    @classmethod
    def from_pinocchio(cls, inertia: Any) -> Inertia:
        """Take over an inertia of Pinocchio.

        Parameters
        ----------
        inertia
            A ``pinocchio.Inertia``: mass, lever, inertia about the mass centre.
        """
        return cls(inertia.mass, inertia.lever, inertia.inertia)

    @classmethod
    def from_mujoco(cls, model: Any, body: int | str) -> Inertia:
        """Take over a body of MuJoCo, in the axes of the body's frame.

        MuJoCo stores principal moments with the rotation of their axes (``body_iquat``, scalar first).

        Parameters
        ----------
        model
            A ``mujoco.MjModel``.
        body
            Name or number of the body.
        """
        k = model.body(body).id
        turn = rotation_matrix(model.body_iquat[k])
        return cls(float(model.body_mass[k]), model.body_ipos[k], turn @ np.diag(model.body_inertia[k]) @ turn.T)

    def pseudo_inertia(self) -> Array:
        """Return the 4 x 4 pseudo-inertia (Wensing, Kim, Slotine 2018, eq. 9).

        It is positive definite exactly for bodies of positive mass density.
        """
        about = self.inertia_origin_kg_m2
        out = np.empty((4, 4))
        out[:3, :3] = 0.5 * np.trace(about) * np.eye(3) - about
        out[:3, 3] = out[3, :3] = self.mass_kg * self.com_m
        out[3, 3] = self.mass_kg
        return out

    @property
    def principal_moments_kg_m2(self) -> Array:
        """Principal moments about the mass centre, ascending, shape (3,)."""
        return np.asarray(np.linalg.eigvalsh(self.inertia_kg_m2), dtype=np.float64)

    @property
    def is_physical(self) -> bool:
        """Whether some distribution of positive mass has these properties."""
        a, b, c = self.principal_moments_kg_m2
        return bool(self.mass_kg > 0.0 and a >= -_TOLERANCE * c and c <= a + b + _TOLERANCE * c)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Inertia):
            return NotImplemented
        return self.mass_kg == other.mass_kg and bool(
            np.array_equal(self.com_m, other.com_m) and np.array_equal(self.inertia_kg_m2, other.inertia_kg_m2)
        )

    __hash__ = None  # type: ignore[assignment]
