"""Telemetry of other programs, each from a file or recorder that the program made."""

import json
import struct

import numpy as np
import pytest

import poinsot as pn
from poinsot import adapters

pytestmark = pytest.mark.extra


@pytest.fixture(scope="module")
def samples():
    rng = np.random.default_rng(3)
    n = 200
    q = rng.normal(size=(n, 4)) * 0.01 + [0.0, 0.0, 0.0, 1.0]
    return {
        "time_s": np.arange(n) * 0.05,
        "omega_rad_s": rng.normal(size=(n, 3)),
        "q_xyzw": q / np.linalg.norm(q, axis=1, keepdims=True),
        "wheel": rng.normal(size=n),
    }


def _check(record, samples, tolerance=0.0):
    assert np.abs(record["omega_y"][1] - samples["omega_rad_s"][:, 1]).max() <= tolerance
    assert np.abs(record["q_w"][1] - samples["q_xyzw"][:, 3]).max() <= max(tolerance, 1e-15)
    assert np.abs(np.diff(record["omega_y"][0]) - 0.05).max() < 2e-9


@pytest.mark.parametrize("columns", [False, True])
def test_exact_mat_of_scipy(samples, tmp_path, columns):
    io = pytest.importorskip("scipy.io")
    rates = samples["omega_rad_s"].T if columns else samples["omega_rad_s"]
    io.savemat(tmp_path / "run.mat", {"t": samples["time_s"], "w": rates, "q": samples["q_xyzw"], "rw1": samples["wheel"]})
    record = adapters.read_mat(tmp_path / "run.mat", time_s="t", omega_rad_s="w", q_xyzw="q", wheel_rad_s={"w1": "rw1"})
    _check(record, samples)
    assert (record["w1_rad_s"][1] == samples["wheel"]).all()
    with pytest.raises(pn.InputError, match="rw1"):
        adapters.read_mat(tmp_path / "run.mat", time_s="nope")


def test_exact_hdf5_of_h5py(samples, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["imu/t"], file["imu/rate"], file["att"] = samples["time_s"], samples["omega_rad_s"], samples["q_xyzw"]
    _check(adapters.read_hdf5(tmp_path / "run.h5", time_s="imu/t", omega_rad_s="imu/rate", q_xyzw="att"), samples)
    with pytest.raises(pn.InputError, match="imu"):
        adapters.read_hdf5(tmp_path / "run.h5", time_s="imu/t", omega_rad_s="gyro")


def test_exact_bag_of_rosbags(samples, tmp_path):
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    t = store.types
    vector, quaternion = t["geometry_msgs/msg/Vector3"], t["geometry_msgs/msg/Quaternion"]
    with rosbag2.Writer(tmp_path / "bag", version=9) as writer:
        imu = writer.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=store)
        joints = writer.add_connection("/joints", "sensor_msgs/msg/JointState", typestore=store)
        for k, time in enumerate(samples["time_s"]):
            ns = 1_773_512_340_000_000_000 + round(time * 1e9)
            header = t["std_msgs/msg/Header"](t["builtin_interfaces/msg/Time"](ns // 10**9, ns % 10**9), "base")
            message = t["sensor_msgs/msg/Imu"](
                header, quaternion(*samples["q_xyzw"][k]), np.zeros(9), vector(*samples["omega_rad_s"][k]), np.zeros(9),
                vector(0.0, 0.0, 0.0), np.zeros(9),
            )  # fmt: skip
            writer.write(imu, ns, store.serialize_cdr(message, "sensor_msgs/msg/Imu"))
            arm = t["sensor_msgs/msg/JointState"](header, ["elbow"], np.array([0.1 * k]), np.array([2.0]), np.zeros(1))
            writer.write(joints, ns, store.serialize_cdr(arm, "sensor_msgs/msg/JointState"))
    record = adapters.read_rosbag(tmp_path / "bag", imu="/imu", attitude="/imu", joints="/joints")
    _check(record, samples)
    assert record["elbow_rad"][1][3] == pytest.approx(0.3) and record["elbow_rad_s"][1][3] == 2.0
    with pytest.raises(pn.InputError, match="/imu"):
        adapters.read_rosbag(tmp_path / "bag", imu="/gyro")


def test_exact_mcap(samples, tmp_path):
    writer_of = pytest.importorskip("mcap.writer")
    with (tmp_path / "run.mcap").open("wb") as file:
        writer = writer_of.Writer(file)
        writer.start()
        schema = writer.register_schema(name="Imu", encoding="jsonschema", data=b"{}")
        channel = writer.register_channel(topic="/imu", message_encoding="json", schema_id=schema)
        for k, time in enumerate(samples["time_s"]):
            body = {"rate": dict(zip("xyz", samples["omega_rad_s"][k])), "q": list(samples["q_xyzw"][k])}
            ns = 1_773_512_340_000_000_000 + round(time * 1e9)
            writer.add_message(channel_id=channel, log_time=ns, publish_time=ns, data=json.dumps(body).encode())
        writer.finish()
    columns = {f"omega_{a}": f"rate.{a}" for a in "xyz"} | {f"q_{a}": f"q.{k}" for k, a in enumerate("xyzw")}
    _check(adapters.read_mcap(tmp_path / "run.mcap", {"/imu": columns}), samples)


def _ulog(samples) -> bytes:
    """A log as PX4 writes it (ULog file format, version 1): PX4 itself is not on PyPI."""

    def message(kind: bytes, payload: bytes) -> bytes:
        return struct.pack("<HB", len(payload), kind[0]) + payload

    out = bytes([0x55, 0x4C, 0x6F, 0x67, 0x01, 0x12, 0x35, 0x01]) + struct.pack("<Q", 0)
    out += message(b"B", bytes(40))
    out += message(b"F", b"vehicle_angular_velocity:uint64_t timestamp;float[3] xyz;")
    out += message(b"F", b"vehicle_attitude:uint64_t timestamp;float[4] q;")
    out += message(b"A", struct.pack("<BH", 0, 0) + b"vehicle_angular_velocity")
    out += message(b"A", struct.pack("<BH", 0, 1) + b"vehicle_attitude")
    for k, time in enumerate(samples["time_s"]):
        us = 5_000_000 + round(time * 1e6)
        x, y, z, w = samples["q_xyzw"][k]
        out += message(b"D", struct.pack("<HQ3f", 0, us, *samples["omega_rad_s"][k]))
        out += message(b"D", struct.pack("<HQ4f", 1, us, w, x, y, z))
    return out


def test_exact_ulog(samples, tmp_path):
    pytest.importorskip("pyulog")
    (tmp_path / "log.ulg").write_bytes(_ulog(samples))
    _check(adapters.read_ulog(tmp_path / "log.ulg"), samples, tolerance=1e-6)


def test_exact_mrp_and_its_shadow_are_one_attitude():
    sigma = np.array([0.3, -0.2, 0.6])
    shadow = -sigma / (sigma @ sigma)
    a, b = adapters.mrp_to_xyzw(sigma), adapters.mrp_to_xyzw(shadow)
    assert min(np.abs(a - b).max(), np.abs(a + b).max()) < 1e-15
    quarter = np.tan(np.pi / 8) * np.array([0.0, 0.0, 1.0])
    assert np.abs(adapters.mrp_to_xyzw(quarter) - [0, 0, np.sqrt(0.5), np.sqrt(0.5)]).max() < 1e-15


def _basilisk(duration_s=60.0, step_s=0.1):
    """A free satellite with three wheels under torques, flown by Basilisk."""
    pytest.importorskip("Basilisk")
    from Basilisk.architecture import messaging
    from Basilisk.simulation import reactionWheelStateEffector, spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros, simIncludeRW

    sim = SimulationBaseClass.SimBaseClass()
    process = sim.CreateNewProcess("process")
    process.addTask(sim.CreateNewTask("task", macros.sec2nano(step_s)))
    craft = spacecraft.Spacecraft()
    craft.hub.mHub = 150.0
    craft.hub.r_BcB_B = [[0.0], [0.0], [0.0]]
    craft.hub.IHubPntBc_B = [[13.9, 0.1, 0.2], [0.1, 16.9, 0.6], [0.2, 0.6, 19.9]]
    craft.hub.omega_BN_BInit = [[0.01], [-0.02], [0.03]]
    # Close to the switch of the shadow set, which is passed in the run.
    craft.hub.sigma_BNInit = [[0.4], [0.5], [0.6]]
    sim.AddModelToTask("task", craft)
    factory = simIncludeRW.rwFactory()
    for axis in np.eye(3):
        factory.create("custom", axis, Omega=100.0, maxMomentum=50.0, Js=0.05, useRWfriction=False, u_max=1.0, label=f"w{axis.argmax()}")
    effector = reactionWheelStateEffector.ReactionWheelStateEffector()
    factory.addToSpacecraft("wheels", effector, craft)
    sim.AddModelToTask("task", effector)
    command = messaging.ArrayMotorTorqueMsgPayload()
    command.motorTorque = [0.2, -0.1, 0.15] + [0.0] * 33
    torque = messaging.ArrayMotorTorqueMsg().write(command)
    effector.rwMotorCmdInMsg.subscribeTo(torque)
    state, speeds = craft.scStateOutMsg.recorder(), effector.rwSpeedOutMsg.recorder()
    sim.AddModelToTask("task", state)
    sim.AddModelToTask("task", speeds)
    sim.InitializeSimulation()
    for k in range(4):
        command.motorTorque = [0.2 * (-1) ** k, -0.1 * (-1) ** (k // 2), 0.15 * (1 if k in (0, 3) else -1)] + [0.0] * 33
        torque.write(command, sim.TotalSim.CurrentNanos)
        sim.ConfigureStopTime(macros.sec2nano(duration_s * (k + 1) / 4))
        sim.ExecuteSimulation()
    return state, speeds


def test_xval_basilisk_satellite_is_identified():
    state, speeds = _basilisk()
    record = adapters.from_basilisk(state=state, wheel_speeds=speeds, wheels=["w1", "w2", "w3"])
    assert not any("wheel4" in name for name in record)
    vehicle = pn.Model.from_dict(
        {
            "schema": "poinsot.model/1", "name": "satellite",
            "body": [{"name": "bus", "mass_kg": 150.0, "com_m": [0, 0, 0], "estimate": ["inertia"],
                      "inertia_kg_m2": {"xx": 15.0, "yy": 16.0, "zz": 21.0}}],
            "wheel": [{"name": f"w{k + 1}", "body": "bus", "axis": np.eye(3)[k], "spin_inertia_kg_m2": 0.05} for k in range(3)],
            "sensor": [{"name": "gyro", "type": "gyro", "noise_rad_s": 1e-6},
                       {"name": "tracker", "type": "attitude", "noise_rad": 1e-6},
                       {"name": "tacho", "type": "wheel_speed", "noise_rad_s": 1e-5}],
        }
    )  # fmt: skip
    answer = pn.identify(vehicle, record)
    body = answer.bodies["bus"]
    truth = np.array([[13.9, 0.1, 0.2], [0.1, 16.9, 0.6], [0.2, 0.6, 19.9]])
    assert answer.rank == (6, 6), str(answer)
    assert np.abs(body.inertia_kg_m2 - truth).max() < 1e-3 * 19.9, str(answer)


XML = """<mujoco><option gravity="0 0 0" timestep="0.002" integrator="RK4"><flag contact="disable"/></option><worldbody>
  <body name="bus"><freejoint/><inertial pos="0.02 -0.01 0.03" mass="60" fullinertia="4 5 6 0.1 0.2 -0.3"/>
    <body name="mast" pos="0 0 0.4"><inertial pos="0 0 0.1" mass="1" fullinertia="0.02 0.02 0.01 0 0 0"/>
      <body name="upper" pos="0.1 0 0.3" quat="0.9238795 0.3826834 0 0">
        <joint name="shoulder" type="hinge" axis="0 0 1" pos="0.05 0 0.02"/>
        <inertial pos="0.4 0.05 0" mass="6" fullinertia="0.1 0.4 0.45 0 0.01 0"/>
        <body name="lower" pos="0.8 0 0"><joint name="elbow" type="hinge" axis="0 1 0"/>
          <inertial pos="0.3 0 0" mass="4" fullinertia="0.05 0.2 0.22 0 0 0"/></body></body></body></body>
</worldbody><actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator></mujoco>"""


def test_xval_model_of_mujoco_has_its_mass_matrix():
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(XML)
    vehicle = adapters.model_from_mujoco(model)
    assert vehicle.bodies == ("bus", "mast", "upper", "lower") and vehicle.coordinates == ("shoulder", "elbow")
    data = mujoco.MjData(model)
    data.qpos[7:] = [0.7, -1.1]
    mujoco.mj_forward(model, data)
    theirs = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, theirs, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, theirs)
    ours = pn.dynamics.mass_matrix(vehicle, [0.7, -1.1])
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_xval_robot_of_mujoco_is_identified():
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(XML)
    data, log = mujoco.MjData(model), adapters.MujocoLog(model)
    for step in range(10_000):
        data.ctrl[:] = [1.5 * np.cos(0.9 * data.time), -1.0 * np.cos(1.3 * data.time)]
        mujoco.mj_forward(model, data)
        if step % 10 == 0:
            log.record(data)
        mujoco.mj_step(model, data)
    record = log.telemetry(noise_rad_s=1e-5, noise_rad=1e-5, noise_m=1e-5, noise_m_s=1e-5, noise_joint_rad=1e-6, noise_joint_rad_s=1e-6)
    values = adapters.model_from_mujoco(
        model,
        sensors=[
            {"name": "gyro", "type": "gyro", "noise_rad_s": 1e-5},
            {"name": "tracker", "type": "attitude", "noise_rad": 1e-5},
            {"name": "position", "type": "position", "noise_m": 1e-5},
            {"name": "velocity", "type": "velocity", "noise_m_s": 1e-5},
            {"name": "encoders", "type": "joint_position", "noise_rad": 1e-6},
            {"name": "rates", "type": "joint_rate", "noise_rad_s": 1e-6},
        ],
    ).to_dict()
    truth = values["body"][3]
    # The payload is 20 % off and unknown; the rest is known.
    values["body"][3] = truth | {"mass_kg": 1.2 * truth["mass_kg"], "estimate": True}
    answer = pn.identify(pn.Model.from_dict(values), record)
    body = answer.bodies["lower"]
    assert np.isfinite(body.mass_kg), str(answer)
    assert abs(body.mass_kg - 4.0) < max(5 * body.mass_sigma_kg, 1e-3 * 4.0), str(answer)
