"""Kernels against Pinocchio, MuJoCo and each other."""

import numpy as np
import pytest

import poinsot as pn

XU = "data/xu2017/model.toml"


@pytest.fixture(scope="module")
def vehicle() -> pn.Model:
    return pn.Model.read(XU)


@pytest.fixture(scope="module")
def states(vehicle):
    rng = np.random.default_rng(7)
    dof = len(vehicle.coordinates)
    return rng.uniform(-2, 2, (5, 3, dof)), rng.normal(size=(5, 3, dof)), rng.normal(size=(5, 3, 6)), rng.normal(size=(5, 3, dof))


@pytest.fixture(scope="module")
def pinocchio(vehicle):
    """The same tree, built joint by joint from the tables of the model."""
    pin = pytest.importorskip("pinocchio")
    values = vehicle.to_dict()
    model = pin.Model()
    model.gravity.setZero()
    body_of = {values["body"][0]["name"]: model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")}
    inertias = {b["name"]: _inertia(pin, b) for b in values["body"]}
    model.appendBodyToJoint(1, inertias[values["body"][0]["name"]], pin.SE3.Identity())
    for joint in values["joint"]:
        quaternion = joint.get("rotation_xyzw", [0.0, 0.0, 0.0, 1.0])
        turn = np.array(joint["rotation_matrix"]) if "rotation_matrix" in joint else pin.Quaternion(np.array(quaternion, float)).matrix()
        place = pin.SE3(turn, np.array(joint["origin_m"], float))
        kind = {"revolute": pin.JointModelRevoluteUnaligned, "prismatic": pin.JointModelPrismaticUnaligned}[joint["type"]]
        axis = np.array(joint["axis"], float)
        index = model.addJoint(body_of[joint["parent"]], kind(axis / np.linalg.norm(axis)), place, joint["name"])
        model.appendBodyToJoint(index, inertias[joint["child"]], pin.SE3.Identity())
        body_of[joint["child"]] = index
    return pin, model, model.createData()


def _inertia(pin, body):
    i = body.get("inertia_kg_m2", {})
    element = lambda name: float(i.get(name, 0.0))  # noqa: E731
    tensor = np.array([[element("".join(sorted(a + b))) for b in "xyz"] for a in "xyz"])
    return pin.Inertia(float(body["mass_kg"]), np.array(body["com_m"], float), tensor)


def _configuration(q):
    return np.concatenate([np.zeros(6), [1.0], q])


def test_xval_mass_matrix_and_momentum_are_those_of_pinocchio(vehicle, states, pinocchio):
    pin, model, data = pinocchio
    q, dq, V, _ = states
    M = pn.dynamics.mass_matrix(vehicle, q)
    h = pn.dynamics.momentum(vehicle, q, dq, V)
    for at in np.ndindex(q.shape[:-1]):
        theirs = pin.crba(model, data, _configuration(q[at]))
        theirs = np.triu(theirs) + np.triu(theirs, 1).T
        assert np.abs(M[at] - theirs).max() < 1e-11 * np.abs(theirs).max()
        velocity = np.concatenate([V[at], dq[at]])
        assert np.abs(h[at] - (theirs @ velocity)[:6]).max() < 1e-11 * np.abs(h[at]).max()


def test_xval_forward_dynamics_is_that_of_pinocchio(vehicle, states, pinocchio):
    pin, model, data = pinocchio
    q, dq, V, tau = states
    wrench = np.array([1.0, -2.0, 3.0, 0.5, 0.1, -0.7])
    acceleration, ddq = pn.dynamics.forward_dynamics(vehicle, q, dq, V, tau, wrench=wrench)
    for at in np.ndindex(q.shape[:-1]):
        velocity = np.concatenate([V[at], dq[at]])
        theirs = pin.aba(model, data, _configuration(q[at]), velocity, np.concatenate([wrench, tau[at]]))
        inertial = theirs[:3] + np.cross(V[at][3:], V[at][:3])
        assert np.abs(acceleration[at] - np.concatenate([inertial, theirs[3:6]])).max() < 1e-8 * np.abs(theirs).max()
        assert np.abs(ddq[at] - theirs[6:]).max() < 1e-8 * np.abs(theirs).max()


def test_xval_jacobian_is_that_of_pinocchio(vehicle, states, pinocchio):
    pin, model, data = pinocchio
    q = states[0]
    last = vehicle.bodies[-1]
    J = pn.dynamics.jacobian(vehicle, last, q)
    for at in np.ndindex(q.shape[:-1]):
        pin.forwardKinematics(model, data, _configuration(q[at]))
        theirs = pin.computeJointJacobian(model, data, _configuration(q[at]), model.njoints - 1)
        turn = data.oMi[model.njoints - 1].rotation
        # Theirs is in the axes of the body; the base stands aligned with the world.
        world = np.vstack([turn @ theirs[:3], turn @ theirs[3:]])
        assert np.abs(J[at] - world).max() < 1e-12


def test_exact_regressor_times_parameters_is_the_momentum(vehicle, states):
    q, dq, V, _ = states
    Y = pn.dynamics.momentum_regressor(vehicle, q, dq, V)
    assert Y.shape == (5, 3, 6, 10 * len(vehicle.bodies))
    assert len(pn.dynamics.parameter_names(vehicle)) == Y.shape[-1]
    momentum = pn.dynamics.momentum(vehicle, q, dq, V)
    assert np.abs(Y @ vehicle.parameters.ravel() - momentum).max() < 1e-11 * np.abs(momentum).max()
    other = vehicle.parameters * 1.7
    assert np.allclose(pn.dynamics.momentum(vehicle, q, dq, V, parameters=other), 1.7 * momentum)


def test_exact_leading_axes_broadcast(vehicle, states):
    q, dq, V, _ = states
    whole = pn.dynamics.momentum(vehicle, q, dq, V[0, 0])
    for at in np.ndindex(q.shape[:-1]):
        assert (whole[at] == pn.dynamics.momentum(vehicle, q[at], dq[at], V[0, 0])).all()
    memory = np.empty((5, 3, 10 * len(vehicle.bodies), 6))
    into = pn.dynamics.momentum_regressor(vehicle, q, dq, V, out=memory)
    assert np.shares_memory(into, memory)
    assert (into == pn.dynamics.momentum_regressor(vehicle, q, dq, V)).all()


@pytest.mark.parametrize(
    ("n", "kernel"),
    [
        (70_003, lambda m, q, dq, V, tau: pn.dynamics.momentum(m, q, dq, V)),
        (6_003, lambda m, q, dq, V, tau: pn.dynamics.momentum_regressor(m, q, dq, V)),
        (6_003, lambda m, q, dq, V, tau: np.concatenate(pn.dynamics.forward_dynamics(m, q, dq, V, tau), axis=-1)),
        (6_000, lambda m, q, dq, V, tau: pn.dynamics.mass_matrix(m, q)),
        (6_000, lambda m, q, dq, V, tau: pn.dynamics.jacobian(m, m.bodies[-1], q)),
    ],
    ids=["momentum", "momentum_regressor", "forward_dynamics", "mass_matrix", "jacobian"],
)
def test_exact_threads_and_lanes_give_the_bits_of_one_state(vehicle, n, kernel):
    """Many states, on all cores and where the kernel can side by side, against calls with one state."""
    rng = np.random.default_rng(1)
    dof = len(vehicle.coordinates)
    given = [rng.normal(size=(n, width)) for width in (dof, dof, 6, dof)]
    whole = kernel(vehicle, *given)
    for k in [*rng.integers(0, n, 200), n - 1]:
        assert (whole[k] == kernel(vehicle, *(x[k] for x in given))).all()


def test_exact_generalised_jacobian_needs_no_momentum(vehicle, states):
    q, dq, _, _ = states
    M = pn.dynamics.mass_matrix(vehicle, q)
    base = -np.linalg.solve(M[..., :6, :6], M[..., :6, 6:] @ dq[..., None])[..., 0]
    assert np.abs(pn.dynamics.momentum(vehicle, q, dq, base)).max() < 1e-10
    full = pn.dynamics.jacobian(vehicle, vehicle.bodies[-1], q, point_m=[0.1, 0.0, 0.2])
    twist = full @ np.concatenate([base, dq], axis=-1)[..., None]
    J = pn.dynamics.jacobian(vehicle, vehicle.bodies[-1], q, point_m=[0.1, 0.0, 0.2], generalised=True)
    assert np.abs(J @ dq[..., None] - twist).max() < 1e-9


def test_xval_motion_is_that_of_mujoco(tmp_path):
    """A bus with two joints under torques: ours against MuJoCo with steps of 0.1 ms."""
    mujoco = pytest.importorskip("mujoco")
    xml = """<mujoco><option gravity="0 0 0" timestep="1e-4" integrator="RK4"><flag contact="disable"/></option><worldbody>
      <body name="bus"><freejoint/><inertial pos="0.1 0 -0.05" mass="40" fullinertia="3 4 5 0.1 0.2 -0.3"/>
        <body name="a" pos="0.5 0 0.2"><joint name="ja" axis="0 0 1"/><inertial pos="0.3 0.05 0" mass="4" fullinertia="0.1 0.3 0.35 0 0 0"/>
          <body name="b" pos="0.6 0 0"><joint name="jb" axis="0 1 0"/><inertial pos="0.2 0 0" mass="2" fullinertia="0.05 0.1 0.12 0 0 0"/></body>
        </body></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    values = {
        "schema": "poinsot.model/1", "name": "two joints",
        "body": [
            {"name": n, "mass_kg": m, "com_m": c, "inertia_kg_m2": dict(zip(("xx", "yy", "zz", "xy", "xz", "yz"), i))}
            for n, m, c, i in [
                ("bus", 40.0, [0.1, 0, -0.05], [3.0, 4.0, 5.0, 0.1, 0.2, -0.3]),
                ("a", 4.0, [0.3, 0.05, 0], [0.1, 0.3, 0.35, 0.0, 0.0, 0.0]),
                ("b", 2.0, [0.2, 0, 0], [0.05, 0.1, 0.12, 0.0, 0.0, 0.0]),
            ]
        ],
        "joint": [
            {"name": "ja", "type": "revolute", "parent": "bus", "child": "a", "origin_m": [0.5, 0, 0.2], "axis": [0, 0, 1.0]},
            {"name": "jb", "type": "revolute", "parent": "a", "child": "b", "origin_m": [0.6, 0, 0], "axis": [0, 1.0, 0]},
        ],
    }  # fmt: skip
    vehicle = pn.Model.from_dict(values)
    q, dq, V, tau = np.array([0.3, -0.5]), np.array([0.2, 0.1]), np.array([0.01, 0.02, -0.03, 0.1, -0.2, 0.05]), np.array([0.4, -0.1])
    data.qpos[:] = [0, 0, 0, 1, 0, 0, 0, *q]
    data.qvel[:] = [*V, *dq]
    data.qfrc_applied[6:] = tau
    times = np.linspace(0.0, 2.0, 5)
    motion = pn.dynamics.integrate(vehicle, times, q, dq, V, tau)
    assert motion.q.shape == (5, 2) and motion.V.shape == (5, 6)
    for k, time in enumerate(times):
        while data.time < time - 5e-5:
            mujoco.mj_step(model, data)
        assert np.abs(motion.q[k] - data.qpos[7:]).max() < 1e-8
        assert np.abs(motion.position_m[k] - data.qpos[:3]).max() < 1e-8
        theirs = data.qpos[[4, 5, 6, 3]]
        assert min(np.abs(motion.q_xyzw[k] - s * theirs).max() for s in (1, -1)) < 1e-8
        assert np.abs(motion.V[k, 3:] - data.qvel[3:6]).max() < 1e-8
    many = pn.dynamics.integrate(vehicle, times, np.stack([q, q + 0.1]), dq, V, tau)
    assert many.q.shape == (2, 5, 2) and (many.q[0] == motion.q).all()
