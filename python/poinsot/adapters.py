"""Telemetry and models of other programs: Basilisk, MuJoCo, MATLAB, HDF5, ROS, MCAP, PX4.

Each function needs the package of that program or format; the extras of `pip install 'poinsot[...]'` bring it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError, need, read_by
from ._model import Model
from ._mujoco import tables
from ._mujoco_log import MujocoLog
from ._telemetry import Telemetry, of_log

__all__ = [
    "MujocoLog",
    "from_basilisk",
    "model_from_mujoco",
    "mrp_to_xyzw",
    "read_hdf5",
    "read_mat",
    "read_mcap",
    "read_rosbag",
    "read_ulog",
]

Array = NDArray[np.float64]
PathLike = str | os.PathLike[str]

_NANOSECOND = 1e-9
_MICROSECOND = 1e-6


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


def model_from_mujoco(
    model: Any, *, base: int | str | None = None, name: str | None = None, sensors: Iterable[Mapping[str, Any]] = ()
) -> Model:
    """Make a vehicle of the subtree of a free body of a ``mujoco.MjModel``; :meth:`Model.from_mjcf` reads a file.

    Parameters
    ----------
    model
        The compiled model. Hinge and slide joints become joints, bodies without a joint are fixed to their parents.
    base
        Body that floats; the first one with a free joint by default. A base welded to the world may be named too.
    name
        Name of the vehicle; that of the model by default.
    sensors
        Tables of ``[[sensor]]``.

    Notes
    -----
    Joint coordinates are those of ``qpos``. A body with several joints becomes a chain of links, of which all but the
    last are massless. Ball joints and active equality constraints are refused. Armature, springs, damping, friction,
    limits, contacts and actuators are left out: a fit takes the motion of joints as measured.
    """
    values = tables(model, base)
    return Model.from_dict(values | {"name": name or values["name"], "sensor": [dict(s) for s in sensors]})


def _taken(source: str, read: Any, time_s: str, names: Mapping[str, Any]) -> Telemetry:
    """Arrays by the arguments of :meth:`Telemetry.from_arrays`, each named in a file."""

    def of(name: Any) -> Any:
        if isinstance(name, Mapping):
            return {key: of(inner) for key, inner in name.items()}
        array = np.asarray(read(str(name)))
        # MATLAB keeps vectors as matrices of one row or column.
        return array.ravel() if array.ndim == 2 and 1 in array.shape else array

    times = of(time_s)
    # The names of the wheels are no names of variables.
    arrays = {argument: name if argument == "wheels" else of(name) for argument, name in names.items()}
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
    io = need("scipy.io", "mat")
    variables = read_by(path, lambda: io.loadmat(path))

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
    h5py = need("h5py", "hdf5")
    with read_by(path, lambda: h5py.File(path, "r")) as file:

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
    highlevel = need("rosbags.highlevel", "ros")
    from pathlib import Path

    stamps: dict[str, list[Any]] = {}
    wanted = [t for t in (imu, attitude, joints) if t is not None]
    store = need("rosbags.typesys", "ros")
    types = store.get_typestore(store.Stores.ROS2_HUMBLE)

    def read() -> None:
        with highlevel.AnyReader([Path(path)], default_typestore=types) as reader:
            connections = [c for c in reader.connections if c.topic in wanted]
            missing = set(wanted) - {c.topic for c in connections}
            if missing or not wanted:
                there = ", ".join(sorted({c.topic for c in reader.connections}))
                raise InputError(f"E0001 {os.fspath(path)}: no topic '{', '.join(sorted(missing))}'; use one of {there}")
            for connection, _, raw in reader.messages(connections=connections):
                stamps.setdefault(connection.topic, []).append(reader.deserialize(raw, connection.msgtype))

    read_by(path, read)
    return _of_ros(stamps, imu, attitude, joints)


def _of_ros(messages: Mapping[str, Sequence[Any]], imu: str | None, attitude: str | None, joints: str | None) -> Telemetry:
    def times(topic: str) -> NDArray[Any]:
        stamps = [m.header.stamp for m in messages[topic]]
        ns = np.array([int(s.sec) * 1_000_000_000 + int(s.nanosec) for s in stamps], dtype=np.int64)
        return ns.astype("datetime64[ns]")

    parts: list[Telemetry] = []
    if imu is not None:
        rates = [[m.angular_velocity.x, m.angular_velocity.y, m.angular_velocity.z] for m in messages[imu]]
        parts.append(of_log(f"<{imu}>", time_s=times(imu), omega_rad_s=rates))
    if attitude is not None:
        turns = [m.orientation if hasattr(m, "orientation") else m.pose.orientation for m in messages[attitude]]
        parts.append(of_log(f"<{attitude}>", time_s=times(attitude), q_xyzw=[[q.x, q.y, q.z, q.w] for q in turns]))
    if joints is not None:
        names = list(messages[joints][0].name)
        columns: dict[str, Any] = {}
        for k, name in enumerate(names):
            columns[f"{name}_rad"] = [m.position[k] for m in messages[joints]]
            if all(len(m.velocity) == len(names) for m in messages[joints]):
                columns[f"{name}_rad_s"] = [m.velocity[k] for m in messages[joints]]
        parts.append(of_log(f"<{joints}>", time_s=times(joints), columns=columns))
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
    reader = need("mcap.reader", "ros")
    rows: dict[str, list[tuple[int, Any]]] = {topic: [] for topic in topics}

    def read() -> None:
        with open(path, "rb") as file:
            for _, channel, message in reader.make_reader(file).iter_messages(topics=list(topics)):
                if channel.message_encoding != "json":
                    raise InputError(
                        f"E0001 {os.fspath(path)}: topic '{channel.topic}' is encoded as {channel.message_encoding}; use read_rosbag"
                    )
                rows[channel.topic].append((message.log_time, json.loads(message.data)))

    read_by(path, read)

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
        parts.append(of_log(f"<{topic}>", time_s=times, columns=table))
    return Telemetry.join(*parts)


# Topics of PX4 with the angular velocity, the better one first, and the field of its three components.
_PX4_RATES = (("vehicle_angular_velocity", "xyz"), ("sensor_combined", "gyro_rad"))


def read_ulog(path: PathLike) -> Telemetry:
    """Read angular velocity and attitude of a log of PX4.

    Body axes are forward, right, down; N is north, east, down. Both are right-handed, so nothing is turned.

    Parameters
    ----------
    path
        The ``.ulg`` file, with the topics ``vehicle_angular_velocity`` (or ``sensor_combined``, in logs before PX4 1.10)
        and ``vehicle_attitude``.

    Notes
    -----
    Times are those of the measurement (``timestamp_sample``), in older logs those of the publication. The angular velocity
    of ``sensor_combined`` includes the bias of the gyro.
    """
    pyulog = need("pyulog", "ulog")
    log = read_by(path, lambda: pyulog.ULog(os.fspath(path)))
    topics = {d.name: d.data for d in log.data_list if d.multi_id == 0}

    def times(data: Mapping[str, Any]) -> Array:
        return np.asarray(data.get("timestamp_sample", data["timestamp"]), dtype=np.float64) * _MICROSECOND

    parts: list[Telemetry] = []
    topic, field = next(((t, f) for t, f in _PX4_RATES if t in topics), ("", ""))
    if topic:
        rates = np.column_stack([topics[topic][f"{field}[{k}]"] for k in range(3)])
        parts.append(of_log(f"<{topic}>", time_s=times(topics[topic]), omega_rad_s=rates))
    if "vehicle_attitude" in topics:
        data = topics["vehicle_attitude"]
        # Scalar first in PX4.
        turns = np.column_stack([data[f"q[{k}]"] for k in (1, 2, 3, 0)]).astype(np.float64)
        turns /= np.linalg.norm(turns, axis=1, keepdims=True)
        parts.append(of_log("<vehicle_attitude>", time_s=times(data), q_xyzw=turns))
    if not parts:
        raise InputError(f"E0001 {os.fspath(path)}: no vehicle_angular_velocity or vehicle_attitude; log them, or use from_arrays")
    return Telemetry.join(*parts)
