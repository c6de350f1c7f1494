"""The vehicle."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _mujoco
from ._core import Model as CoreModel

PathLike = str | os.PathLike[str]


class Model:
    """A checked vehicle: bodies, joints, wheels, thrusters, sensors, and what of them is unknown.

    Use :meth:`read`, :meth:`from_urdf`, :meth:`from_mjcf`, :meth:`from_text` or :meth:`from_dict`. To change a model, change its
    dictionary and make a model of it; every way goes through the same checks. A call of the class is a TypeError.

    Examples
    --------
    >>> import poinsot as pn
    >>> vehicle = pn.Model.read("data/stsat3/model.toml")
    >>> vehicle.bodies
    ('spacecraft',)
    >>> values = vehicle.to_dict()
    >>> values["body"][0]["mass_kg"] = 152.0
    >>> pn.Model.from_dict(values).parameters[0, 0]
    np.float64(152.0)
    """

    __slots__ = ("_core",)
    _core: CoreModel

    def __init__(self, *arguments: object, **options: object) -> None:
        raise TypeError(
            "Model is not called directly; use Model.read(path), Model.from_urdf(path), Model.from_mjcf(path), "
            "Model.from_text(text) or Model.from_dict(values)"
        )

    @classmethod
    def _of(cls, core: CoreModel) -> Model:
        made = cls.__new__(cls)
        made._core = core
        return made

    @classmethod
    def read(cls, path: PathLike) -> Model:
        """Read a model file (TOML, ``poinsot.model/1``).

        Parameters
        ----------
        path
            The file.

        Raises
        ------
        InputError
            The file is refused; ``lines`` holds all findings.
        """
        return cls._of(CoreModel.read(path))

    @classmethod
    def from_urdf(cls, path: PathLike) -> Model:
        """Read a robot from URDF. Sensors and unknowns are still to be added, see :meth:`to_dict`.

        Parameters
        ----------
        path
            The file. Its root link is the base.
        """
        return cls._of(CoreModel.from_urdf(path))

    @classmethod
    def from_mjcf(cls, path: PathLike, *, base: str | None = None) -> Model:
        """Read a robot from MJCF, compiled by MuJoCo (``pip install 'poinsot[mujoco]'``).

        Sensors and unknowns are still to be added, see :meth:`to_dict`. :func:`poinsot.adapters.model_from_mujoco` says
        what is taken over and takes a model that is compiled already.

        Parameters
        ----------
        path
            The file.
        base
            Body that floats; the first one with a free joint by default. A base welded to the world may be named too.

        Raises
        ------
        InputError
            MuJoCo does not compile the file, or the robot has a ball joint or an active equality constraint.
        """
        return cls.from_dict(_mujoco.tables(_mujoco.compiled(path), base))

    @classmethod
    def from_text(cls, text: str, name: str | None = None) -> Model:
        """Read the text of a model file.

        Parameters
        ----------
        text
            TOML, ``poinsot.model/1``.
        name
            What messages call it.
        """
        return cls._of(CoreModel.from_text(text, name))

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Model:
        """Make a model of the tables of a model file.

        Parameters
        ----------
        values
            Keys as in the file; numbers may be arrays of NumPy. Entries that are None are left out.
        """
        return cls._of(CoreModel.from_dict(dict(values)))

    def to_dict(self) -> dict[str, Any]:
        """Return the tables of the model file; :meth:`from_dict` takes them back."""
        values: dict[str, Any] = json.loads(self._core.json())
        return values

    def to_toml(self) -> str:
        """Return the text of the model file."""
        return self._core.to_toml()

    def write(self, path: PathLike) -> None:
        """Write the model file. An earlier file stays until the new one is complete.

        Parameters
        ----------
        path
            The file.
        """
        self._core.write(path)

    def check(self) -> dict[str, Any]:
        """Return what the model describes, as ``poinsot check --json`` prints it."""
        found: dict[str, Any] = json.loads(self._core.check()[0])
        return found

    def with_map(self, path: PathLike) -> Model:
        """Return the vehicle with the ``[telemetry]`` table of another file.

        Parameters
        ----------
        path
            A map or a model file.
        """
        return Model._of(self._core.with_map(path))

    @property
    def name(self) -> str:
        """Name of the vehicle."""
        return self._core.name

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies; the first is the base."""
        return tuple(self._core.bodies)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the joints that move, in the order of the joint coordinates `q`."""
        return tuple(self._core.coordinates)

    @property
    def coordinate_units(self) -> tuple[str, ...]:
        """Units of `q`: ``"rad"`` or ``"m"``."""
        return tuple(self._core.coordinate_units)

    @property
    def wheels(self) -> tuple[str, ...]:
        """Names of the wheels."""
        return tuple(self._core.wheels)

    @property
    def thrusters(self) -> tuple[str, ...]:
        """Names of the thrusters."""
        return tuple(self._core.thrusters)

    @property
    def sensors(self) -> tuple[str, ...]:
        """Names of the sensors."""
        return tuple(self._core.sensors)

    @property
    def parameters(self) -> NDArray[np.float64]:
        """Nominal inertial parameters, shape (bodies, 10).

        A row holds m, mc_x, mc_y, mc_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the origin of the body's frame, in
        its axes; kg, kg m, kg m2. The order is that of Pinocchio's ``Inertia.toDynamicParameters()``.
        """
        return np.array(self._core.parameters, dtype=np.float64).reshape(-1, 10)

    def __repr__(self) -> str:
        return f"<poinsot.Model {self.name!r}: {len(self.bodies)} bodies, {len(self.coordinates)} joint coordinates>"

    def __str__(self) -> str:
        return self._core.check()[1]

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return (Model.from_text, (self.to_toml(),))
