"""Telemetry of other programs, each from a file or recorder that the program made."""

import hashlib
import json
import urllib.request

import numpy as np
import pytest

import poinsot as pn
from poinsot import adapters
from poinsot._telemetry import of_log

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
    of_one = adapters.read_mat(tmp_path / "run.mat", time_s="t", wheel_rad_s="rw1", wheels=["w1"])
    assert (of_one["w1_rad_s"][1] == samples["wheel"]).all()
    with pytest.raises(pn.InputError, match="rw1"):
        adapters.read_mat(tmp_path / "run.mat", time_s="nope")


def test_exact_hdf5_of_h5py(samples, tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "run.h5", "w") as file:
        file["imu/t"], file["imu/rate"], file["att"] = samples["time_s"], samples["omega_rad_s"], samples["q_xyzw"]
    _check(adapters.read_hdf5(tmp_path / "run.h5", time_s="imu/t", omega_rad_s="imu/rate", q_xyzw="att"), samples)
    with pytest.raises(pn.InputError, match="imu"):
        adapters.read_hdf5(tmp_path / "run.h5", time_s="imu/t", omega_rad_s="gyro")


@pytest.mark.parametrize("version", [1, 2])
def test_exact_bag_of_rosbags(samples, tmp_path, version):
    """Bags of ROS 1 and ROS 2."""
    rosbag = pytest.importorskip(f"rosbags.rosbag{version}")
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
    serialize = store.serialize_ros1 if version == 1 else store.serialize_cdr
    t = store.types
    vector, quaternion = t["geometry_msgs/msg/Vector3"], t["geometry_msgs/msg/Quaternion"]
    # A message of ROS 1 has a counter in its header.
    counter = [0] if version == 1 else []
    path = tmp_path / ("run.bag" if version == 1 else "run")
    with rosbag.Writer(path, **({} if version == 1 else {"version": 9})) as writer:
        imu = writer.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=store)
        joints = writer.add_connection("/joints", "sensor_msgs/msg/JointState", typestore=store)
        for k, time in enumerate(samples["time_s"]):
            ns = 1_773_512_340_000_000_000 + round(time * 1e9)
            header = t["std_msgs/msg/Header"](*counter, t["builtin_interfaces/msg/Time"](ns // 10**9, ns % 10**9), "base")
            message = t["sensor_msgs/msg/Imu"](
                header, quaternion(*samples["q_xyzw"][k]), np.zeros(9), vector(*samples["omega_rad_s"][k]), np.zeros(9),
                vector(0.0, 0.0, 0.0), np.zeros(9),
            )  # fmt: skip
            writer.write(imu, ns, serialize(message, "sensor_msgs/msg/Imu"))
            arm = t["sensor_msgs/msg/JointState"](header, ["elbow"], np.array([0.1 * k]), np.array([2.0]), np.zeros(1))
            writer.write(joints, ns, serialize(arm, "sensor_msgs/msg/JointState"))
    record = adapters.read_rosbag(path, imu="/imu", attitude="/imu", joints="/joints")
    _check(record, samples)
    assert record["elbow_rad"][1][3] == pytest.approx(0.3) and record["elbow_rad_s"][1][3] == 2.0
    with pytest.raises(pn.InputError, match="/imu"):
        adapters.read_rosbag(path, imu="/gyro")


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


def test_exact_rows_of_one_time_of_a_log_are_joined():
    """A log may write a message twice; arrays may not."""
    twice = {"time_s": [0.0, 0.1, 0.1, 0.2], "omega_rad_s": np.ones((4, 3))}
    assert of_log("<log>", **twice)["omega_x"][0].tolist() == [0.0, 0.1, 0.2]
    with pytest.raises(pn.InputError, match="E0208"):
        pn.Telemetry.from_arrays(**twice)


# Logs of PX4, published with the reader pyulog under the BSD licence: a flight of 2016, and a simulation of 2021.
PX4_LOGS = "https://raw.githubusercontent.com/PX4/pyulog/3cf17793f14709713ab297d3743314c658874068/test/"
PX4_SHA256 = {
    "sample.ulg": "81952e6059bc095717e7911c010e07f85749d6b04d332a5ffc51575a3fd0a558",
    "sample_logging_tagged_and_default_params.ulg": "32f564608d46caf5a4cbb1cb0cd0dc839fb9512b06c6d1384fb96ec3d6c9173d",
}


def _px4_log(root, name):
    """A log of PX4, kept in target/px4 once it has been fetched."""
    pytest.importorskip("pyulog")
    path = root / "target/px4" / name
    if not path.exists():
        try:
            content = urllib.request.urlopen(PX4_LOGS + name, timeout=30).read()
        except OSError as error:
            pytest.skip(f"{PX4_LOGS + name} cannot be reached ({error})")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    assert hashlib.sha256(path.read_bytes()).hexdigest() == PX4_SHA256[name]
    return path


def test_xval_attitude_of_a_px4_flight_turns_as_its_gyro(root):
    """Rates from the attitudes of a flight against the gyro: a wrong order, axis or frame has no correlation."""
    record = adapters.read_ulog(_px4_log(root, "sample.ulg"))
    times, rate_times = record["q_x"][0], record["omega_x"][0]
    assert times.size == 6461 and rate_times.size == 17070
    q = np.column_stack([record[f"q_{a}"][1] for a in "xyzw"])
    v, w = q[:, :3], q[:, 3:]
    turn = w[:-1] * v[1:] - w[1:] * v[:-1] - np.cross(v[:-1], v[1:])
    rate = 2.0 * turn * np.sign(np.sum(q[1:] * q[:-1], axis=1, keepdims=True)) / np.diff(times)[:, None]
    gyro = np.column_stack([np.interp(0.5 * (times[1:] + times[:-1]), rate_times, record[f"omega_{a}"][1]) for a in "xyz"])
    for axis in range(3):
        assert np.corrcoef(rate[:, axis], gyro[:, axis])[0, 1] > 0.95


def test_exact_px4_times_are_those_of_the_measurement(root):
    """The fields of a newer log, sample by sample."""
    pyulog = pytest.importorskip("pyulog")
    path = _px4_log(root, "sample_logging_tagged_and_default_params.ulg")
    record = adapters.read_ulog(path)
    data = {d.name: d.data for d in pyulog.ULog(str(path)).data_list if d.multi_id == 0}
    for topic, channel, field in (("vehicle_angular_velocity", "omega_y", "xyz[1]"), ("vehicle_attitude", "q_w", "q[0]")):
        time_s, values = record[channel]
        assert np.abs(time_s - data[topic]["timestamp_sample"] * 1e-6).max() < 1e-9
        # PX4 normalises in single precision.
        assert np.abs(values - data[topic][field]).max() < 2 * np.finfo(np.float32).eps


@pytest.mark.parametrize(
    ("package", "read"),
    [
        ("scipy.io", lambda path: adapters.read_mat(path, time_s="t")),
        ("h5py", lambda path: adapters.read_hdf5(path, time_s="t")),
        ("rosbags.highlevel", lambda path: adapters.read_rosbag(path, imu="/imu")),
        ("mcap.reader", lambda path: adapters.read_mcap(path, {"/imu": {"omega_x": "x"}})),
        ("pyulog", adapters.read_ulog),
        ("mujoco", pn.Model.from_mjcf),
    ],
)
def test_errors_of_readers_of_other_packages(tmp_path, package, read):
    """A file that is missing, empty or of another kind is an error of Poinsot with its path."""
    pytest.importorskip(package)
    for name, content in (("missing.bag", None), ("empty.bag", b""), ("other.bag", b"time_s,omega_x\n0.0,0.1\n" * 50)):
        path = tmp_path / name
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(pn.InputError) as refused:
            read(path)
        assert refused.value.place == str(path) and refused.value.advice, name


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


# Hinges and slides off the origins of their bodies, several in a body, references, welded bodies, a body without a name, a
# second object that is no part of the vehicle.
TREE = """<mujoco model="inspector"><compiler angle="radian"/><worldbody>
  <body name="debris" pos="9 0 0"><freejoint/><geom size="0.1" mass="3"/></body>
  <body name="bus"><freejoint/><inertial pos="0.02 -0.01 0.03" mass="60" fullinertia="4 5 6 0.1 0.2 -0.3"/>
    <body name="mast" pos="0 0 0.4" quat="0.6 0.2 -0.3 0.4"><inertial pos="0 0 0.1" mass="1" fullinertia="0.02 0.02 0.01 0 0 0"/>
      <body name="gimbal" pos="0.1 0.2 0.3" quat="0.9 0.3 0.1 -0.2">
        <joint name="pan" axis="0 0 1" pos="0.05 -0.1 0.02" ref="0.4"/>
        <joint name="reach" type="slide" axis="1 2 0" pos="0.3 0.1 0" ref="-0.2"/>
        <joint name="tilt" axis="0 1 1" pos="0.02 0.07 -0.03" ref="-0.7"/>
        <inertial pos="0.4 0.05 0" mass="6" fullinertia="0.1 0.4 0.45 0 0.01 0"/>
        <body pos="0.8 0 0.1"><joint axis="0 1 0.3" pos="0 0.1 0"/><inertial pos="0.3 0 0" mass="4" fullinertia="0.05 0.2 0.22 0 0 0"/>
          <body name="camera" pos="0.2 0 0" quat="0 1 0 0"><inertial pos="0 0 0.1" mass="0.5" diaginertia="0.01 0.01 0.01"/></body>
        </body></body></body>
    <body name="boom" pos="-0.5 0 0"><joint name="extension" type="slide" axis="-1 0 0" pos="0.1 0 0"/>
      <inertial pos="-0.4 0 0" mass="2" fullinertia="0.01 0.2 0.2 0 0 0"/></body>
  </body></worldbody>BELOW</mujoco>"""


def test_xval_mjcf_has_mass_centre_and_mass_matrix_of_mujoco(tmp_path):
    """Total mass, mass centre and joint-space inertia at random configurations."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "inspector.xml"
    path.write_text(TREE.replace("BELOW", ""))
    vehicle, model = pn.Model.from_mjcf(path, base="bus"), mujoco.MjModel.from_xml_path(str(path))
    assert vehicle.name == "inspector"
    assert vehicle.bodies == ("bus", "mast", "gimbal_pan", "gimbal_reach", "gimbal", "body5", "camera", "boom")
    assert vehicle.coordinates == ("pan", "reach", "tilt", "body5_joint", "extension")
    assert adapters.model_from_mujoco(model, base="bus").to_dict() == vehicle.to_dict()
    data, base = mujoco.MjData(model), model.body("bus").id
    first = int(model.jnt_qposadr[model.body_jntadr[base]])
    dofs = np.arange(model.nv)[int(model.jnt_dofadr[model.body_jntadr[base]]) :]
    for q in np.random.default_rng(11).uniform(-2.0, 2.0, (20, len(vehicle.coordinates))):
        data.qpos[first + 7 :] = q
        mujoco.mj_forward(model, data)
        theirs = _mass_matrix(mujoco, model, data)[np.ix_(dofs, dofs)]
        ours = pn.dynamics.mass_matrix(vehicle, q)
        assert np.abs(ours - theirs).max() < 1e-12 * np.abs(theirs).max()
        mass = model.body_subtreemass[base]
        com = np.array([ours[1, 5], ours[2, 3], ours[0, 4]]) / mass
        assert abs(ours[0, 0] - mass) < 1e-12 * mass and np.abs(com - data.subtree_com[base]).max() < 1e-12


def _mass_matrix(mujoco, model, data):
    full = np.zeros((model.nv, model.nv))
    # The arguments changed in MuJoCo 4.
    mujoco.mj_fullM(model, full, data.qM) if hasattr(data, "qM") else mujoco.mj_fullM(model, data, full)
    return full


EQUALITY = '<equality><joint name="coupling" joint1="pan" joint2="tilt"/></equality>'


@pytest.mark.parametrize(
    ("change", "base", "named"),
    [
        (("BELOW", EQUALITY), "bus", "equality 'coupling'.* joint constraint; remove it"),
        (('name="extension" type="slide" axis="-1 0 0"', 'name="socket" type="ball"'), "bus", "joint 'socket'.*ball joint; replace"),
        (("", ""), "gimbal", "base 'gimbal'.*not free; add"),
        (("", ""), "satellite", "base 'satellite'.*use one of debris, bus"),
        (("<freejoint/>", ""), None, "no body has a free joint; add"),
        (("</body>", ""), "bus", "E0101 .*inspector.xml: it cannot be read .*; correct the file"),
    ],
)
def test_errors_of_mjcf_name_what_has_no_model(tmp_path, change, base, named):
    pytest.importorskip("mujoco")
    path = tmp_path / "inspector.xml"
    path.write_text(TREE.replace(*change).replace("BELOW", ""))
    with pytest.raises(pn.InputError, match=named):
        pn.Model.from_mjcf(path, base=base)


def test_exact_mjcf_of_a_robot_on_a_fixed_base_floats_by_name(tmp_path):
    """An arm for a table: its foot is welded to the world, and named as the base."""
    pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(TREE.replace("<freejoint/>", "").replace("BELOW", EQUALITY.replace("<joint ", '<joint active="false" ')))
    vehicle = pn.Model.from_mjcf(path, base="bus")
    assert vehicle.bodies[0] == "bus" and vehicle.check()["mass_kg"] == 73.5


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
