"""Joints on springs and flexible modes against MuJoCo and Basilisk, which share no code with us."""

import csv
import json
import os
import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

ELEMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
# Name, mass kg, mass centre m, inertia xx, yy, zz, xy, xz, yz about it, kg m2.
BODIES = {
    "bus": (40.0, [0.1, 0.0, -0.05], [3.0, 4.0, 5.0, 0.1, 0.2, -0.3]),
    "panel": (4.0, [0.05, 0.5, 0.02], [0.34, 0.12, 0.42, 0.01, 0.02, -0.01]),
    "tip": (1.5, [0.0, 0.3, 0.1], [0.06, 0.02, 0.06, 0.0, 0.0, 0.005]),
    "slosh": (3.0, [0.02, 0.0, 0.01], [0.02, 0.03, 0.03, 0.0, 0.001, 0.0]),
}
# Name, parent, child, whether it slides, origin, axis, stiffness, damping, rest, start, start rate.
ROOT = ("root", "bus", "panel", False, [0.0, 0.4, 0.1], [1.0, 0.0, 0.0], 8.0, 0.02, 0.0, 0.3, -0.2)
FOLD = ("fold", "panel", "tip", False, [0.0, 1.0, 0.0], [0.6, 0.0, 0.8], 1.5, 0.01, 0.1, -0.4, 0.5)
TANK = ("tank", "bus", "slosh", True, [-0.2, 0.1, -0.3], [0.0, 0.6, 0.8], 6.0, 0.1, 0.02, 0.05, 0.1)
SECONDS, RATE_HZ = 20, 4
SENSORS = """
[[sensor]]
name = "gyro"
type = "gyro"
noise_rad_s = 1e-14
[[sensor]]
name = "tracker"
type = "attitude"
noise_rad = 1e-14
[momentum]
linear_N_s = "estimate"
angular_N_m_s = "estimate"
"""


def _body(name, numbers):
    mass, com, inertia = numbers
    elements = ", ".join(f"{e} = {x}" for e, x in zip(ELEMENTS, inertia))
    return f'[[body]]\nname = "{name}"\nmass_kg = {mass}\ncom_m = {com}\ninertia_kg_m2 = {{ {elements} }}\n'


def _joint(joint):
    name, parent, child, slides, origin, axis, stiffness, damping, rest, _, _ = joint
    keys = ("stiffness_N_per_m", "damping_N_s_per_m", "rest_m") if slides else ("stiffness_N_m_per_rad", "damping_N_m_s_per_rad", "rest_rad")
    spring = ", ".join(f"{key} = {x}" for key, x in zip(keys, (stiffness, damping, rest)))
    kind = "prismatic" if slides else "revolute"
    return (
        f'[[joint]]\nname = "{name}"\ntype = "{kind}"\nparent = "{parent}"\nchild = "{child}"\n'
        f"origin_m = {origin}\naxis = {axis}\nspring_damper = {{ {spring} }}\n"
    )


def _start(joint):
    unit = "m" if joint[3] else "rad"
    rate = "rate_m_s" if joint[3] else "rate_rad_s"
    return f'[[initial.joint]]\njoint = "{joint[0]}"\nposition_{unit} = {joint[9]}\n{rate} = {joint[10]}\n'


def _simulated(command, folder, model, case):
    """Columns of the record of a case."""
    folder.mkdir(exist_ok=True)
    head = 'schema = "poinsot.model/1"\nname = "flexible"\nexact = true\n'
    (folder / "model.toml").write_text(head + model + SENSORS)
    head = f'schema = "poinsot.case/2"\nmodel = "model.toml"\nduration_s = {SECONDS}.0\n'
    (folder / "case.toml").write_text(head + case + f"[output]\nrate_hz = {RATE_HZ}\n")
    done = command("simulate", folder / "case.toml", "--out", folder / "sim")
    assert done.returncode == 0, done.stderr
    with open(folder / "sim" / "telemetry.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == SECONDS * RATE_HZ + 1
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def _stacked(record, names):
    return np.column_stack([record[name] for name in names.split()])


def _mujoco_model(joints, timestep, actuator="", bodies=BODIES):
    mujoco = pytest.importorskip("mujoco")

    def body(name, at, joint):
        mass, com, inertia = bodies[name]
        words = lambda row: " ".join(str(x) for x in row)  # noqa: E731
        inside = "".join(body(j[2], j[4], hinge(j)) for j in joints if j[1] == name)
        site = '<site name="thruster" pos="0.3 -0.2 0.5"/>' if name == "bus" else ""
        return (
            f'<body name="{name}" pos="{words(at)}">{joint}{site}'
            f'<inertial pos="{words(com)}" mass="{mass}" fullinertia="{words(inertia)}"/>{inside}</body>'
        )

    def hinge(joint):
        name, _, _, slides, _, axis, stiffness, damping, rest, _, _ = joint
        kind = "slide" if slides else "hinge"
        return (
            f'<joint name="{name}" type="{kind}" axis="{axis[0]} {axis[1]} {axis[2]}" '
            f'stiffness="{stiffness}" damping="{damping}" springref="{rest}"/>'
        )

    return mujoco, mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option gravity="0 0 0" timestep="{timestep}" integrator="RK4">'
        f'<flag contact="disable"/></option><worldbody>{body("bus", [0, 0, 0], "<freejoint/>")}</worldbody>'
        f"<actuator>{actuator}</actuator></mujoco>"
    )


def _attitude_error(ours, theirs):
    """Largest difference of quaternions, whatever their sign."""
    return np.abs(ours * np.sign((ours * theirs).sum(axis=1))[:, None] - theirs).max()


def test_xval_springs_swing_as_in_mujoco(command, tmp_path):
    """Two hinges in a row and a sliding mass on springs, on a bus that turns."""
    joints = (ROOT, FOLD, TANK)
    w, v = [0.05, -0.08, 0.12], [0.01, 0.02, -0.03]
    model = "".join(_body(*item) for item in BODIES.items()) + "".join(map(_joint, joints))
    case = f"[initial]\nomega_rad_s = {w}\nv_m_s = {v}\n" + "".join(map(_start, joints))
    ours = _simulated(command, tmp_path / "springs", model, case)

    timestep = 1e-3
    mujoco, theirs = _mujoco_model(joints, timestep)
    data = mujoco.MjData(theirs)
    data.qpos[7:], data.qvel[6:] = [j[9] for j in joints], [j[10] for j in joints]
    data.qvel[:3], data.qvel[3:6] = v, w
    states = []
    for _ in ours["time_s"]:
        states.append(np.concatenate([data.qpos, data.qvel[3:6]]))
        mujoco.mj_step(theirs, data, round(1 / RATE_HZ / timestep))
    states = np.array(states)
    differences = [
        _attitude_error(_stacked(ours, "q_x q_y q_z q_w"), states[:, [4, 5, 6, 3]]),
        np.abs(_stacked(ours, "r_x r_y r_z root_rad fold_rad tank_m") - states[:, [0, 1, 2, 7, 8, 9]]).max(),
        np.abs(_stacked(ours, "omega_x omega_y omega_z") - states[:, 10:]).max(),
    ]
    print("largest difference of attitude, positions, rates:", differences)
    assert max(differences) < 1e-9
    # The springs did something: each joint moved by more than a tenth.
    assert np.ptp(states[:, 7:10], axis=0).min() > 0.1


@pytest.mark.parametrize(("modes", "fall"), [(("tank",), 7.0), (("root",), 6.0), (("root", "tank"), 4.0)])
def test_xval_modes_are_right_to_second_order(command, tmp_path, modes, fall):
    """A panel and a tank as modes, beside the exact ones of MuJoCo, under a thrust that is halved twice.

    Thrust, rates and deflections are of one size e. What the mode of a tank leaves out is of size e^3. That of a panel leaves
    out that its mass centre moves on a circle, and two modes the product of both: a small part of size e^2.
    """
    panel, slosh = BODIES["panel"], (3.0, [0.0, 0.0, 0.0], [1e-9, 1e-9, 1e-9, 0.0, 0.0, 0.0])
    parts, joints, tables = [(BODIES["bus"], [0.0, 0.0, 0.0])], [], ""
    for joint, body in ((ROOT, panel), (TANK, slosh)):
        if joint[0] in modes:
            parts.append((body, joint[4]))
            joints.append(joint[:8] + (0.0, 0.0, 0.0))
            tables += _mode(joint, body)
    thruster = '[[thruster]]\nname = "thruster"\nbody = "bus"\nposition_m = [0.3, -0.2, 0.5]\nforce_direction = [0.6, 0.0, 0.8]\n'
    model = _body("bus", _whole(parts)) + tables + thruster
    timestep = 1e-3
    mujoco, theirs = _mujoco_model(joints, timestep, '<motor site="thruster" gear="0.6 0 0.8 0 0 0"/>', {**BODIES, "slosh": slosh})
    errors = []
    for force in (0.25, 0.125, 0.0625):
        firing = f'[[firing]]\nthruster = "thruster"\non_s = 0.0\noff_s = 5.0\nforce_N = {force}\n'
        ours = _simulated(command, tmp_path / f"{force}", model, firing)
        data, rates = mujoco.MjData(theirs), []
        for time in ours["time_s"]:
            rates.append(data.qvel[3:6].copy())
            data.ctrl[0] = force if time < 5.0 else 0.0
            mujoco.mj_step(theirs, data, round(1 / RATE_HZ / timestep))
        errors.append(np.abs(_stacked(ours, "omega_x omega_y omega_z") - np.array(rates)).max())
    falls = np.array(errors[:-1]) / errors[1:]
    print(modes, "largest difference, rad/s:", errors, "falls by", falls, "; rates up to", np.abs(rates).max() * 4)
    assert falls.min() > fall and errors[0] < 1e-5, (errors, falls)


def _mode(joint, body):
    """The table of the mode that a hinged or a sliding body is."""
    head = f'name = "{joint[0]}"\nbody = "bus"\naxis = {joint[5]}\nmass_kg = {body[0]}\n'
    if joint[3]:
        return f"[[tank]]\n{head}position_m = {joint[4]}\nstiffness_N_per_m = {joint[6]}\ndamping_N_s_per_m = {joint[7]}\n"
    elements = ", ".join(f"{e} = {x}" for e, x in zip(ELEMENTS, body[2]))
    return (
        f"[[panel]]\n{head}hinge_m = {joint[4]}\ncom_m = {body[1]}\ninertia_kg_m2 = {{ {elements} }}\n"
        f"stiffness_N_m_per_rad = {joint[6]}\ndamping_N_m_s_per_rad = {joint[7]}\n"
    )


def _whole(parts):
    """Mass, mass centre and inertia of bodies at places, in one set of axes."""
    mass = sum(body[0] for body, _ in parts)
    places = [np.array(body[1]) + np.array(at) for body, at in parts]
    com = sum(body[0] * place for (body, _), place in zip(parts, places)) / mass
    total = np.zeros((3, 3))
    for (body, _), place in zip(parts, places):
        xx, yy, zz, xy, xz, yz = body[2]
        r = place - com
        total += np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) + body[0] * (r @ r * np.eye(3) - np.outer(r, r))
    return mass, com.tolist(), [float(total[i]) for i in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def test_xval_hinged_bodies_and_slosh_are_those_of_basilisk(command, tmp_path):
    """A hinged panel and a particle of slosh on a bus that turns and drifts."""
    if not os.environ.get("POINSOT_CONSUMERS"):
        pytest.importorskip("Basilisk")
    from Basilisk.simulation import hingedRigidBodyStateEffector, linearSpringMassDamper, spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros

    column = lambda row: [[float(x)] for x in row]  # noqa: E731
    w, v = [0.05, -0.08, 0.12], [0.01, 0.02, -0.03]
    mass, com, (xx, yy, zz, xy, xz, yz) = BODIES["bus"]
    craft = spacecraft.Spacecraft()
    craft.hub.mHub, craft.hub.r_BcB_B = mass, column(com)
    craft.hub.IHubPntBc_B = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    craft.hub.v_CN_NInit, craft.hub.omega_BN_BInit = column(v), column(w)
    panel = hingedRigidBodyStateEffector.HingedRigidBodyStateEffector()
    panel.mass, panel.d, panel.k, panel.c = 4.0, 0.5, 8.0, 0.02
    # Its first axis points from the mass centre to the hinge: -y of the bus; its second is the hinge.
    panel.dcm_HB, panel.IPntS_S = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], np.diag([0.12, 0.42, 0.34]).tolist()
    panel.r_HB_B, panel.thetaInit, panel.thetaDotInit = column([0.0, 0.4, 0.1]), 0.3, -0.2
    slosh = linearSpringMassDamper.LinearSpringMassDamper()
    slosh.massInit, slosh.k, slosh.c = 3.0, 6.0, 0.1
    slosh.r_PB_B, slosh.pHat_B = column([-0.2, 0.1, -0.3]), column([0.0, 0.6, 0.8])
    slosh.rhoInit, slosh.rhoDotInit = 0.05, 0.1
    sim = SimulationBaseClass.SimBaseClass()
    sim.CreateNewProcess("p").addTask(sim.CreateNewTask("t", macros.sec2nano(0.001)))
    for effector in (panel, slosh):
        craft.addStateEffector(effector)
    log, hinge = craft.scStateOutMsg.recorder(macros.sec2nano(1 / RATE_HZ)), panel.hingedRigidBodyOutMsg.recorder(macros.sec2nano(1 / RATE_HZ))
    for part in (craft, panel, slosh, log, hinge):
        sim.AddModelToTask("t", part)
    sim.InitializeSimulation()
    sim.ConfigureStopTime(macros.sec2nano(float(SECONDS)))
    sim.ExecuteSimulation()

    bodies = {
        "bus": BODIES["bus"],
        "panel": (4.0, [0.0, 0.5, 0.0], [0.42, 0.12, 0.34, 0.0, 0.0, 0.0]),
        "slosh": (3.0, [0.0, 0.0, 0.0], [0.0] * 6),
    }
    joints = (ROOT, TANK[:8] + (0.0,) + TANK[9:])
    model = "".join(_body(*item) for item in bodies.items()) + "".join(map(_joint, joints))
    start = f"[initial]\nomega_rad_s = {w}\nv_m_s = {np.array(log.v_BN_N)[0].tolist()}\nr_m = {np.array(log.r_BN_N)[0].tolist()}\n"
    ours = _simulated(command, tmp_path / "basilisk", model, start + "".join(map(_start, joints)))
    q = _stacked(ours, "q_x q_y q_z q_w")
    differences = [
        np.abs(q[:, :3] / (1 + q[:, 3:]) - np.array(log.sigma_BN)).max(),
        np.abs(_stacked(ours, "r_x r_y r_z") - np.array(log.r_BN_N)).max(),
        np.abs(ours["root_rad"] - np.array(hinge.theta)).max(),
        np.abs(_stacked(ours, "omega_x omega_y omega_z") - np.array(log.omega_BN_B)).max(),
    ]
    print("largest difference of attitude, positions, rates:", differences)
    assert max(differences) < 1e-9


def test_xval_exported_springs_are_those_of_mujoco_and_basilisk(command, tmp_path):
    """What `identify` finds of a spring is what the programs read."""
    mujoco = pytest.importorskip("mujoco")
    known = "damping_N_m_s_per_rad = 0.02 }"
    model = Path("data/cases/hinged_panel_truth.toml").read_text()
    assert known in model
    model = model.replace(known, known[:-2] + ', estimate = ["stiffness", "damping"] }')
    (tmp_path / "model.toml").write_text(model.replace("yz = 0.59 }", 'yz = 0.59 }\nestimate = ["inertia"]', 1))
    assert command("simulate", "data/cases/hinged_panel.toml", "--out", tmp_path / "sim").returncode == 0
    out = tmp_path / "answer"
    done = command("identify", tmp_path / "model.toml", tmp_path / "sim" / "telemetry.csv", "--out", out)
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads((out / "estimate.json").read_text())["nuisance"]
    stiffness, damping = (found[f"hinge.{key}"]["value"] for key in ("stiffness_N_m_per_rad", "damping_N_m_s_per_rad"))
    (tmp_path / "bus.xml").write_text(
        '<mujoco><worldbody><body name="bus"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><body name="panel">'
        '<joint name="hinge" damping="9"/><inertial pos="0 0.5 0" mass="4" diaginertia="0.34 0.12 0.46"/></body></body></worldbody></mujoco>'
    )
    done = command("export", out, "--to", "mjcf", "--onto", tmp_path / "bus.xml", "-o", tmp_path / "new.xml")
    assert done.returncode == 0, done.stderr
    theirs = mujoco.MjModel.from_xml_path(str(tmp_path / "new.xml"))
    k = theirs.joint("hinge").id
    assert np.ravel(theirs.jnt_stiffness[k])[0] == stiffness
    assert np.ravel(theirs.dof_damping[theirs.jnt_dofadr[k]])[0] == damping
    done = command("export", out, "--to", "basilisk", "-o", tmp_path / "identified.py")
    assert done.returncode == 0, done.stderr
    effector = SimpleNamespace()
    runpy.run_path(str(tmp_path / "identified.py"))["set_spring"](effector, "hinge")
    assert (effector.k, effector.c) == (stiffness, damping)
