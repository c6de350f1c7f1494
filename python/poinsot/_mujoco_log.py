"""Samples of a simulation of MuJoCo as telemetry."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError
from ._mujoco import base_of, bodies_of, moving_joints
from ._telemetry import Telemetry

Array = NDArray[np.float64]


class MujocoLog:
    """Samples of a ``mujoco.MjData`` as the sensors of a free base would read them.

    Parameters
    ----------
    model
        The compiled model.
    base
        Free body; the first one by default.

    Notes
    -----
    Call :meth:`record` after ``mj_step`` or ``mj_forward``. MuJoCo's quaternion has the scalar first; the angular velocity of a
    free joint is in body axes, its linear velocity in world axes.
    """

    def __init__(self, model: Any, base: int | str | None = None) -> None:
        root = base_of(model, base, welded=False)
        joint = int(model.body_jntadr[root])
        self._q, self._v = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self._joints: list[tuple[str, str, int, int]] = []
        for body in list(bodies_of(model, root))[1:]:
            for label, kind, k in moving_joints(model, body):
                unit = "rad" if kind == "revolute" else "m"
                self._joints.append((label, unit, int(model.jnt_qposadr[k]), int(model.jnt_dofadr[k])))
        self._rows: list[tuple[float, Array, Array]] = []

    def record(self, data: Any) -> None:
        """Take a sample.

        Parameters
        ----------
        data
            The ``mujoco.MjData`` of the model.
        """
        self._rows.append((float(data.time), np.array(data.qpos), np.array(data.qvel)))

    def telemetry(
        self,
        *,
        noise_rad_s: float = 0.0,
        noise_rad: float = 0.0,
        noise_m: float | None = None,
        noise_m_s: float | None = None,
        noise_joint_rad: float = 0.0,
        noise_joint_rad_s: float = 0.0,
        seed: int = 0,
    ) -> Telemetry:
        """Return the record, with white noise of these standard deviations.

        Parameters
        ----------
        noise_rad_s, noise_rad
            Of the gyro and of the attitude.
        noise_m, noise_m_s
            Of position and velocity of the base; None leaves them out.
        noise_joint_rad, noise_joint_rad_s
            Of joint positions and rates (m and m/s of slides).
        seed
            Of the noise.
        """
        if not self._rows:
            raise InputError("E0001 log: no sample; call record after every step")
        rng = np.random.default_rng(seed)
        time_s = np.array([row[0] for row in self._rows])
        qpos, qvel = np.array([row[1] for row in self._rows]), np.array([row[2] for row in self._rows])

        def noisy(values: Array, sigma: float) -> Array:
            return values + sigma * rng.standard_normal(values.shape)

        w, x, y, z = qpos[:, self._q + 3 : self._q + 7].T
        turn = 0.5 * noise_rad * rng.standard_normal((time_s.size, 3))
        # A small turn in body axes: q (1, turn / 2).
        attitude = np.stack(
            [
                x + w * turn[:, 0] + y * turn[:, 2] - z * turn[:, 1],
                y + w * turn[:, 1] + z * turn[:, 0] - x * turn[:, 2],
                z + w * turn[:, 2] + x * turn[:, 1] - y * turn[:, 0],
                w - x * turn[:, 0] - y * turn[:, 1] - z * turn[:, 2],
            ],
            axis=1,
        )
        attitude /= np.linalg.norm(attitude, axis=1, keepdims=True)
        columns: dict[str, Array] = {}
        for label, kind, at, rate in self._joints:
            columns[f"{label}_{kind}"] = noisy(qpos[:, at], noise_joint_rad)
            columns[f"{label}_{kind}_s"] = noisy(qvel[:, rate], noise_joint_rad_s)
        return Telemetry.from_arrays(
            time_s=time_s,
            omega_rad_s=noisy(qvel[:, self._v + 3 : self._v + 6], noise_rad_s),
            q_xyzw=attitude,
            position_m=None if noise_m is None else noisy(qpos[:, self._q : self._q + 3], noise_m),
            velocity_m_s=None if noise_m_s is None else noisy(qvel[:, self._v : self._v + 3], noise_m_s),
            columns=columns,
            name="<MuJoCo>",
        )
