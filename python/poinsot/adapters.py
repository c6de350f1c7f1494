"""Telemetry and models of other programs: Basilisk, MuJoCo, MATLAB, HDF5, ROS, MCAP, PX4.

Each function needs the package of that program or format; the extras of `pip install 'poinsot[...]'` bring it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError
from ._inertia import Inertia
from ._model import Model
from ._telemetry import Telemetry

Array = NDArray[np.float64]
PathLike = str | os.PathLike[str]

_NANOSECOND = 1e-9
_MICROSECOND = 1e-6


def _need(package: str, extra: str) -> Any:
    try:
        return import_module(package)
    except ImportError:
        raise InputError(f"E0001 {package}: this package is missing; pip install 'poinsot[{extra}]'") from None


def mrp_to_xyzw(sigma_BN: ArrayLike) -> Array:
    """Convert modified Rodrigues parameters of Basilisk to attitudes of Poinsot.

    Parameters
    ----------
    sigma_BN
        Shape (..., 3). The shadow set describes the same attitude.

    Returns
    -------
    ndarray, shape (..., 4)
        ``R_NB`` as a quaternion, Hamilton, scalar last: body to inertial (Schaub and Junkins, eq. 3.143).
    """
    sigma = np.asarray(sigma_BN, dtype=np.float64)
    square = np.sum(sigma * sigma, axis=-1, keepdims=True)
    return np.asarray(np.concatenate([2.0 * sigma, 1.0 - square], axis=-1) / (1.0 + square))


def from_basilisk(
    *,
    state: Any = None,
    imu: Any = None,
    wheel_speeds: Any = None,
    wheels: Sequence[str] = (),
    position: bool = False,
) -> Telemetry:
    """Make a record of recorders of Basilisk. Each keeps its own time base.

    Parameters
    ----------
    state
        Recorder of a ``SCStatesMsg`` or ``NavAttMsg``: attitude, and rate where `imu` is not given.
    imu
        Recorder of an ``IMUSensorMsg``: rate (``AngVelPlatform``).
    wheel_speeds
        Recorder of an ``RWSpeedMsg``; only its first ``len(wheels)`` entries are wheels, the others are padding.
    wheels
        Names of the wheels in the order in which they were added.
    position
        Take position and velocity of `state` too. Only for simulations without gravity: Poinsot's N falls freely.
    """
    parts: list[Telemetry] = []
    if state is not None:
        arrays: dict[str, Any] = {"q_xyzw": mrp_to_xyzw(state.sigma_BN)}
        if imu is None:
            arrays["omega_rad_s"] = state.omega_BN_B
        if position:
            arrays["position_m"] = state.r_BN_N
            arrays["velocity_m_s"] = state.v_BN_N
        parts.append(Telemetry.from_arrays(time_s=_nanoseconds(state.times()), name="<Basilisk state>", **arrays))
    if imu is not None:
        parts.append(
            Telemetry.from_arrays(time_s=_nanoseconds(imu.times()), omega_rad_s=imu.AngVelPlatform, name="<Basilisk IMU>")
        )
    if wheel_speeds is not None:
        speeds = np.asarray(wheel_speeds.wheelSpeeds)
        if not 0 < len(wheels) <= speeds.shape[1]:
            raise InputError(f"E0001 wheels: {len(wheels)} names; give one name per wheel, in the order of Basilisk")
        named = {name: speeds[:, k] for k, name in enumerate(wheels)}
        parts.append(
            Telemetry.from_arrays(time_s=_nanoseconds(wheel_speeds.times()), wheel_rad_s=named, name="<Basilisk wheels>")
        )
    if not parts:
        raise InputError("E0001 recorders: none is given; give at least one")
    return Telemetry.join(*parts)


def _nanoseconds(times: Any) -> Array:
    return np.asarray(times, dtype=np.float64) * _NANOSECOND


def model_from_mujoco(model: Any, *, base: int | str | None = None, name: str = "mujoco", sensors: Iterable[Mapping[str, Any]] = ()) -> Model:
    """Make a vehicle of the subtree of a free body of a ``mujoco.MjModel``.

    Parameters
    ----------
    model
        The compiled model. Hinge and slide joints become joints, bodies without a joint are fixed to their parents.
    base
        Free body; the first one with a free joint by default.
    name
        Name of the vehicle.
    sensors
        Tables of ``[[sensor]]``.
    """
    mujoco = _need("mujoco", "mujoco")
    free = [b for b in range(1, model.nbody) if _joint_types(mujoco, model, b) == [int(mujoco.mjtJoint.mjJNT_FREE)]]
    if base is None:
        if not free:
            raise InputError("E0001 model: no body has a free joint; add <freejoint/> to the base")
        root = free[0]
    else:
        root = int(model.body(base).id)
    bodies: list[dict[str, Any]] = []
    joints: list[dict[str, Any]] = []
    taken = {root}
    for body in range(root, model.nbody):
        parent = int(model.body_parentid[body])
        if body != root and parent not in taken:
            continue
        taken.add(body)
        label = model.body(body).name or f"body{body}"
        # A joint of MuJoCo stands at a point of its body; the frame of a body of Poinsot has its origin at the joint.
        joint = None if body == root else _mujoco_joint(mujoco, model, body)
        shift = np.zeros(3) if joint is None else np.array(joint.pop("shift"))
        inertia = Inertia.from_mujoco(model, body)
        tensor = inertia.inertia_kg_m2
        bodies.append(
            {
                "name": label,
                "mass_kg": inertia.mass_kg,
                "com_m": inertia.com_m - shift,
                "inertia_kg_m2": {a + b: tensor["xyz".index(a), "xyz".index(b)] for a, b in ("xx", "yy", "zz", "xy", "xz", "yz")},
            }
        )
        if joint is None:
            continue
        parent_shift = next((np.array(j["_shift"]) for j in joints if j["child"] == (model.body(parent).name or f"body{parent}")), np.zeros(3))
        w, x, y, z = model.body_quat[body]
        turned = _rotation(x, y, z, w) @ shift
        joints.append(
            {
                **joint,
                "parent": model.body(parent).name or f"body{parent}",
                "child": label,
                "origin_m": model.body_pos[body] + turned - parent_shift,
                "rotation_xyzw": [x, y, z, w],
                "_shift": shift,
            }
        )
    for entry in joints:
        del entry["_shift"]
    return Model.from_dict(
        {"schema": "poinsot.model/1", "name": name, "body": bodies, "joint": joints, "sensor": [dict(s) for s in sensors]}
    )


def _joint_types(mujoco: Any, model: Any, body: int) -> list[int]:
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    return [int(model.jnt_type[k]) for k in range(first, first + count)]


def _rotation(x: float, y: float, z: float, w: float) -> Array:
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + 2.0 * (w * k + k @ k))


def _mujoco_joint(mujoco: Any, model: Any, body: int) -> dict[str, Any]:
    label = model.body(body).name or f"body{body}"
    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE): "revolute", int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic"}
    found = _joint_types(mujoco, model, body)
    if not found:
        return {"name": f"{label}_fixed", "type": "fixed", "shift": np.zeros(3)}
    if len(found) > 1 or found[0] not in kinds:
        raise InputError(f"E0001 body '{label}': its joints are not one hinge or slide; split it into bodies of one joint each")
    k = int(model.body_jntadr[body])
    reference = float(model.qpos0[model.jnt_qposadr[k]])
    if reference != 0.0:
        raise InputError(f"E0001 joint '{model.joint(k).name}': its ref is {reference}; set ref to 0")
    return {
        "name": model.joint(k).name or f"{label}_joint",
        "type": kinds[found[0]],
        "axis": model.jnt_axis[k],
        "shift": model.jnt_pos[k],
    }


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
        mujoco = _need("mujoco", "mujoco")
        free = int(mujoco.mjtJoint.mjJNT_FREE)
        roots = [b for b in range(1, model.nbody) if free in _joint_types(mujoco, model, b)]
        root = int(model.body(base).id) if base is not None else (roots[0] if roots else -1)
        if root not in roots:
            raise InputError("E0001 base: no free body; add <freejoint/> to the base")
        joint = int(model.body_jntadr[root])
        self._q, self._v = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        self._joints: list[tuple[str, str, int, int]] = []
        for k in range(model.njnt):
            kind = {int(mujoco.mjtJoint.mjJNT_HINGE): "rad", int(mujoco.mjtJoint.mjJNT_SLIDE): "m"}.get(int(model.jnt_type[k]))
            label = model.joint(k).name or f"{model.body(int(model.jnt_bodyid[k])).name or 'body' + str(model.jnt_bodyid[k])}_joint"
            if kind:
                self._joints.append((label, kind, int(model.jnt_qposadr[k]), int(model.jnt_dofadr[k])))
        self._rows: list[tuple[float, Array, Array]] = []

    def record(self, data: Any) -> None:
        """Take a sample."""
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


def _taken(source: str, read: Any, time_s: str, names: Mapping[str, Any]) -> Telemetry:
    """Arrays by the arguments of :meth:`Telemetry.from_arrays`, each named in a file."""

    def of(name: Any) -> Any:
        if isinstance(name, Mapping):
            return {key: of(inner) for key, inner in name.items()}
        array = np.asarray(read(str(name)))
        # MATLAB keeps vectors as matrices of one row or column.
        return array.ravel() if array.ndim == 2 and 1 in array.shape else array

    times = of(time_s)
    arrays = {argument: of(name) for argument, name in names.items()}
    for argument, array in arrays.items():
        # Vectors of samples may stand in columns.
        if isinstance(array, np.ndarray) and array.ndim == 2 and array.shape[0] != times.shape[0] == array.shape[1]:
            arrays[argument] = array.T
    return Telemetry.from_arrays(time_s=times, name=f"<{source}>", **arrays)


def read_mat(path: PathLike, *, time_s: str, **names: Any) -> Telemetry:
    """Read a MAT file (versions 4 to 7.2; 7.3 is HDF5, see :func:`read_hdf5`).

    Parameters
    ----------
    path
        The file.
    time_s
        Name of the variable with the times, s.
    **names
        Arguments of :meth:`Telemetry.from_arrays`, with the names of variables in place of arrays.
    """
    variables = _need("scipy.io", "mat").loadmat(path)

    def read(name: str) -> Any:
        if name not in variables:
            there = ", ".join(v for v in variables if not v.startswith("__"))
            raise InputError(f"E0001 {os.fspath(path)}: no variable '{name}'; use one of {there}")
        return variables[name]

    return _taken(os.path.basename(os.fspath(path)), read, time_s, names)


def read_hdf5(path: PathLike, *, time_s: str, **names: Any) -> Telemetry:
    """Read an HDF5 file, of MATLAB 7.3 too.

    Parameters
    ----------
    path
        The file.
    time_s
        Path of the dataset with the times, s.
    **names
        Arguments of :meth:`Telemetry.from_arrays`, with the paths of datasets in place of arrays.
    """
    h5py = _need("h5py", "hdf5")
    with h5py.File(path, "r") as file:

        def read(name: str) -> Any:
            if name not in file:
                raise InputError(f"E0001 {os.fspath(path)}: no dataset '{name}'; use one of {', '.join(file)}")
            return file[name][()]

        return _taken(os.path.basename(os.fspath(path)), read, time_s, names)


def read_rosbag(path: PathLike, *, imu: str | None = None, attitude: str | None = None, joints: str | None = None) -> Telemetry:
    """Read a bag of ROS 1 or ROS 2.

    Parameters
    ----------
    path
        The bag: a file of ROS 1, a folder of ROS 2.
    imu
        Topic of ``sensor_msgs/Imu``: angular velocity.
    attitude
        Topic of ``sensor_msgs/Imu`` or ``geometry_msgs/PoseStamped``: orientation, body to world.
    joints
        Topic of ``sensor_msgs/JointState``: positions and velocities by name.
    """
    highlevel = _need("rosbags.highlevel", "ros")
    from pathlib import Path

    stamps: dict[str, list[Any]] = {}
    wanted = [t for t in (imu, attitude, joints) if t is not None]
    store = _need("rosbags.typesys", "ros")
    types = store.get_typestore(store.Stores.ROS2_HUMBLE)
    with highlevel.AnyReader([Path(path)], default_typestore=types) as reader:
        connections = [c for c in reader.connections if c.topic in wanted]
        missing = set(wanted) - {c.topic for c in connections}
        if missing or not wanted:
            there = ", ".join(sorted({c.topic for c in reader.connections}))
            raise InputError(f"E0001 {os.fspath(path)}: no topic '{', '.join(sorted(missing))}'; use one of {there}")
        for connection, _, raw in reader.messages(connections=connections):
            stamps.setdefault(connection.topic, []).append(reader.deserialize(raw, connection.msgtype))
    return _of_ros(stamps, imu, attitude, joints)


def _of_ros(messages: Mapping[str, Sequence[Any]], imu: str | None, attitude: str | None, joints: str | None) -> Telemetry:
    def times(topic: str) -> NDArray[Any]:
        stamps = [m.header.stamp for m in messages[topic]]
        ns = np.array([int(s.sec) * 1_000_000_000 + int(s.nanosec) for s in stamps], dtype=np.int64)
        return ns.astype("datetime64[ns]")

    parts: list[Telemetry] = []
    if imu is not None:
        rates = [[m.angular_velocity.x, m.angular_velocity.y, m.angular_velocity.z] for m in messages[imu]]
        parts.append(Telemetry.from_arrays(time_s=times(imu), omega_rad_s=rates, name=f"<{imu}>"))
    if attitude is not None:
        turns = [m.orientation if hasattr(m, "orientation") else m.pose.orientation for m in messages[attitude]]
        parts.append(
            Telemetry.from_arrays(time_s=times(attitude), q_xyzw=[[q.x, q.y, q.z, q.w] for q in turns], name=f"<{attitude}>")
        )
    if joints is not None:
        names = list(messages[joints][0].name)
        columns: dict[str, Any] = {}
        for k, name in enumerate(names):
            columns[f"{name}_rad"] = [m.position[k] for m in messages[joints]]
            if all(len(m.velocity) == len(names) for m in messages[joints]):
                columns[f"{name}_rad_s"] = [m.velocity[k] for m in messages[joints]]
        parts.append(Telemetry.from_arrays(time_s=times(joints), columns=columns, name=f"<{joints}>"))
    return Telemetry.join(*parts)


def read_mcap(path: PathLike, topics: Mapping[str, Mapping[str, str]]) -> Telemetry:
    """Read an MCAP file with messages in JSON; times are the log times. Bags of ROS: :func:`read_rosbag`.

    Parameters
    ----------
    path
        The file.
    topics
        By topic: columns with the way to their field, for example ``{"/imu": {"omega_x": "rate.x"}}``.
    """
    reader = _need("mcap.reader", "ros")
    rows: dict[str, list[tuple[int, Any]]] = {topic: [] for topic in topics}
    with open(path, "rb") as file:
        for _, channel, message in reader.make_reader(file).iter_messages(topics=list(topics)):
            if channel.message_encoding != "json":
                raise InputError(
                    f"E0001 {os.fspath(path)}: topic '{channel.topic}' is encoded as {channel.message_encoding}; use read_rosbag"
                )
            rows[channel.topic].append((message.log_time, json.loads(message.data)))

    def field(message: Any, way: str) -> float:
        for key in way.split("."):
            message = message[int(key)] if isinstance(message, list) else message.get(key)
            if message is None:
                return float("nan")
        return float(message)

    parts: list[Telemetry] = []
    for topic, columns in topics.items():
        if not rows[topic]:
            raise InputError(f"E0001 {os.fspath(path)}: no message of topic '{topic}'; correct its name")
        times = np.array([row[0] for row in rows[topic]], dtype=np.int64).astype("datetime64[ns]")
        table = {column: np.array([field(row[1], way) for row in rows[topic]]) for column, way in columns.items()}
        parts.append(Telemetry.from_arrays(time_s=times, columns=table, name=f"<{topic}>"))
    return Telemetry.join(*parts)


def read_ulog(path: PathLike) -> Telemetry:
    """Read angular velocity and attitude of a log of PX4.

    Body axes are forward, right, down; N is north, east, down. Both are right-handed, so nothing is turned.

    Parameters
    ----------
    path
        The ``.ulg`` file, with the topics ``vehicle_angular_velocity`` and ``vehicle_attitude``.
    """
    log = _need("pyulog", "ulog").ULog(os.fspath(path))
    topics = {d.name: d.data for d in log.data_list if d.multi_id == 0}
    parts: list[Telemetry] = []
    if "vehicle_angular_velocity" in topics:
        data = topics["vehicle_angular_velocity"]
        rates = np.column_stack([data[f"xyz[{k}]"] for k in range(3)])
        times = np.asarray(data["timestamp"], dtype=np.float64) * _MICROSECOND
        parts.append(Telemetry.from_arrays(time_s=times, omega_rad_s=rates, name="<vehicle_angular_velocity>"))
    if "vehicle_attitude" in topics:
        data = topics["vehicle_attitude"]
        # Scalar first in PX4.
        turns = np.column_stack([data[f"q[{k}]"] for k in (1, 2, 3, 0)]).astype(np.float64)
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        times = np.asarray(data["timestamp"], dtype=np.float64) * _MICROSECOND
        parts.append(Telemetry.from_arrays(time_s=times, q_xyzw=turns, name="<vehicle_attitude>"))
    if not parts:
        raise InputError(f"E0001 {os.fspath(path)}: no vehicle_angular_velocity or vehicle_attitude; log them, or use from_arrays")
    return Telemetry.join(*parts)
