"""Vehicles flown by MuJoCo 4.0.0 and Basilisk 2.12.1, which share no code with Poinsot or the NumPy simulator.

What an engine gives is the motion at fixed times. The bound needs the same motion by the NumPy simulator, with the joint angles or
wheel speeds of the engine as inputs; `deviation` is the largest difference between both, in sigmas of the sensors."""

import numpy as np

from flight import Flight, families, first, motion


class Sampled:
    """Values and rates at equal steps, between them by Hermite cubics; for all seeds alike, or `count` copies."""

    def __init__(self, step_s, values, rates, count):
        self.step_s, self.values, self.rates, self.count = step_s, values, rates, count

    def at(self, t):
        k = min(int(t / self.step_s + 1e-9), len(self.values) - 2)
        h, s = self.step_s, t / self.step_s - k
        a, b, da, db = self.values[k], self.values[k + 1], self.rates[k] * h, self.rates[k + 1] * h
        value = a + s * da + s * s * (3 * (b - a) - 2 * da - db) + s**3 * (2 * (a - b) + da + db)
        slope = (da + 2 * s * (3 * (b - a) - 2 * da - db) + 3 * s * s * (2 * (a - b) + da + db)) / h
        return value, slope

    def value(self, t):
        return np.broadcast_to(self.at(t)[0], (self.count, self.values.shape[1]))

    def slope(self, t):
        return np.broadcast_to(self.at(t)[1], (self.count, self.values.shape[1]))


def take(family, flight, motion_of_engine, sigma):
    """The engine's motion in place of the NumPy simulator's; `sigma`: of rates, attitude, for the deviation."""
    attitude, place, rates, velocity = motion_of_engine
    turned = motion.product(flight.attitude * [-1, -1, -1, 1], attitude)
    family.deviation = max(abs(rates - flight.rates).max() / sigma[0], 2 * abs(turned[:, :3]).max() / sigma[1])
    flight.attitude, flight.place, flight.rates, flight.velocity = motion_of_engine
    family.set_flight(flight)
    return family.copies(flight)


def body_mjcf(k, bodies, joints, inner):
    mass, centre, about = (x[0] for x in bodies[k])
    full = " ".join(f"{about[families.ELEMENTS[e]]:.15g}" for e in ("xx", "yy", "zz", "xy", "xz", "yz"))
    words = lambda v: " ".join(f"{x:.15g}" for x in v)
    inertial = f'<inertial pos="{words(centre)}" mass="{mass:.15g}" fullinertia="{full}"/>'
    if k == 0:
        return f'<body name="b0"><freejoint name="root"/>{inertial}<site name="imu"/>{inner}</body>'
    _, at, seat, axis = (x if isinstance(x, int) else x[0] for x in joints[k - 1])
    x, y, z, w = eval(families.rotation_text(seat))
    return (
        f'<body name="b{k}" pos="{words(at)}" quat="{words([w, x, y, z])}"><joint name="joint{k}" axis="{words(axis)}"/>'
        f"{inertial}{inner}</body>"
    )


def mjcf(bodies, joints, step_s):
    """A serial arm on a free base, joint torques as controls; also used by the baseline of MuJoCo's toolbox."""
    inner = ""
    for k in reversed(range(len(bodies))):
        inner = body_mjcf(k, bodies, joints, inner)
    names = [f"joint{k + 1}" for k in range(len(joints))]
    motors = "".join(f'<motor name="motor_{j}" joint="{j}"/>' for j in names)
    sensors = "".join(f'<jointpos name="q_{j}" joint="{j}"/>' for j in names)
    sensors += "".join(f'<jointvel name="v_{j}" joint="{j}"/>' for j in names)
    sensors += '<gyro name="gyro" site="imu"/><framequat name="attitude" objtype="site" objname="imu"/>'
    sensors += '<framepos name="place" objtype="site" objname="imu"/><framelinvel name="velocity" objtype="site" objname="imu"/>'
    option = f'<option gravity="0 0 0" timestep="{step_s}" integrator="RK4"/><compiler balanceinertia="false"/>'
    return (
        f"<mujoco>{option}<worldbody>{inner}</worldbody><actuator>{motors}</actuator><sensor>{sensors}</sensor></mujoco>"
    )


def mujoco_motion(model, curve, rest, duration_s, step_s):
    """Rest, then joint torques that follow a curve, held over each step: motion at the start of every step, and the torques."""
    import mujoco

    data = mujoco.MjData(model)
    data.qvel[:] = 0.0
    rows = []
    for k in range(int(round(duration_s / step_s)) + 1):
        wanted, rate = curve.value(k * step_s)[0] - rest, curve.slope(k * step_s)[0] * min(1.0, k * step_s / 5.0)
        data.ctrl[:] = 60.0 * (wanted - data.qpos[7:]) + 80.0 * (rate - data.qvel[6:])
        mujoco.mj_forward(model, data)
        rows.append(np.concatenate([data.qpos, data.qvel, data.ctrl]))
        mujoco.mj_step(model, data)
    return np.array(rows)


def mujoco_arm(family, joints, unknown):
    """A free-floating arm with a load under joint torques, at rest at the start; the torques are read too (torque.csv)."""
    import mujoco

    draw, count, step_s = family.draw, len(family.seeds), 0.02
    bodies, chain = [families.bus(draw, 200.0, 400.0)], []
    for j in range(joints):
        at = draw.uniform(-0.6, 0.6, 3) if j == 0 else np.array([0.6, 0, 0]) + np.zeros((count, 3))
        chain.append((j, at, motion.matrix(draw.turn()), draw.direction()))
        mass = draw.uniform(10.0, 20.0)
        link = np.einsum("si,ij->sij", np.array([0.02, 0.08, 0.08]) * mass[:, None], np.eye(3))
        bodies.append((mass, np.array([0.3, 0, 0]) + 0.02 * draw.normal(3), link))
    load = draw.uniform(30.0, 60.0)
    bodies[joints] = (load, 0.15 * draw.normal(3), load[:, None, None] * families.tensor(draw, np.full(count, 0.7)))
    family.bodies(bodies, unknown)
    families.joint_texts(family, chain)
    curve = families.Curve(draw, joints, 1.2, (15.0, 40.0))
    model = mujoco.MjModel.from_xml_string(mjcf(bodies, chain, step_s))
    rows = mujoco_motion(model, curve, curve.value(0.0)[0], 60.0, step_s)
    free = joints + 7
    attitude, place = rows[:, [4, 5, 6, 3]], rows[:, :3]
    velocity, rates = rows[:, free : free + 3], rows[:, free + 3 : free + 6]
    angles, speeds, torques = rows[:, 7:free], rows[:, free + 6 : free + 6 + joints], rows[:, free + 6 + joints :]
    sampled, one = Sampled(step_s, angles, speeds, count), Sampled(step_s, angles, speeds, 1)
    at = np.arange(0, len(rows), 5) * step_s
    inputs = lambda t: (one.value(t), one.slope(t), np.zeros((1, 0)))
    begin = (attitude[:1], place[:1], np.zeros((1, 6)))
    single = motion.Vehicle(first(bodies), first(chain))
    flight = Flight(single, inputs, begin, at, step_s)
    attitude, place, rates, velocity = take(family, flight, [x[::5] for x in (attitude, place, rates, velocity)], (2e-5, 5e-5))
    families.gyro(family, at, rates, 2e-5)
    families.tracker(family, at[::2], attitude[:, ::2], 5e-5)
    families.vector(family, "position", "pos", at[::2], place[:, ::2], "m", 1e-3)
    families.vector(family, "velocity", "vel", at[::2], velocity[:, ::2], "m_s", 2e-4)
    families.encoders(family, at, sampled, 2e-5, 1e-4)
    read = torques + 0.01 * family.draw.normal(*torques.shape)
    family.column("torque", np.arange(len(rows)) * step_s, [f"joint{j + 1}_Nm" for j in range(joints)], read)


def basilisk(hub, start, duration_s, step_s, wheels=(), torques=None, push=None, appendage=None):
    """Basilisk's spacecraft: motion and wheel speeds at every step. `torques(t)` of the wheels' motors and `push(t)` torque about the
    base's origin and force, all held over a step. `appendage`: a configured state effector."""
    from Basilisk.architecture import messaging
    from Basilisk.simulation import extForceTorque, reactionWheelStateEffector, spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros

    column = lambda v: [[float(x)] for x in v]
    simulation = SimulationBaseClass.SimBaseClass()
    simulation.CreateNewProcess("process").addTask(simulation.CreateNewTask("task", macros.sec2nano(step_s)))
    craft = spacecraft.Spacecraft()
    craft.hub.mHub, craft.hub.r_BcB_B = float(hub[0]), column(hub[1])
    craft.hub.IHubPntBc_B = [[float(x) for x in row] for row in hub[2]]
    q, rates = start
    craft.hub.sigma_BNInit, craft.hub.omega_BN_BInit = column(q[:3] / (1 + q[3])), column(rates)
    kept, motors, rotor, outside = [], messaging.ArrayMotorTorqueMsg(), None, None
    if wheels:
        rotor = reactionWheelStateEffector.ReactionWheelStateEffector()
        for axis, spin in wheels:
            w = reactionWheelStateEffector.RWConfigPayload()
            w.gsHat_B, w.rWB_B, w.Js, w.Jt, w.Jg, w.mass = column(axis), column(np.zeros(3)), spin, spin, spin, 1.0
            w.RWModel, w.Omega = reactionWheelStateEffector.BalancedWheels, 0.0
            w.u_max = w.u_min = w.Omega_max = w.P_max = -1.0
            w.fCoulomb = w.cViscous = w.fStatic = 0.0
            w.betaStatic = -1.0
            rotor.addReactionWheel(w)
            kept.append(w)
        rotor.rwMotorCmdInMsg.subscribeTo(motors)
        craft.addStateEffector(rotor)
        simulation.AddModelToTask("task", rotor, 70)
    if appendage is not None:
        craft.addStateEffector(appendage)
        simulation.AddModelToTask("task", appendage, 60)
    force, torque = messaging.CmdForceBodyMsg(), messaging.CmdTorqueBodyMsg()
    if push is not None:
        outside = extForceTorque.ExtForceTorque()
        outside.cmdForceBodyInMsg.subscribeTo(force)
        outside.cmdTorqueInMsg.subscribeTo(torque)
        craft.addDynamicEffector(outside)
        simulation.AddModelToTask("task", outside, 90)
    simulation.AddModelToTask("task", craft, 50)

    def command(k):
        if torques is not None:
            motors.write(messaging.ArrayMotorTorqueMsgPayload(motorTorque=list(torques(k * step_s))), k)
        if push is not None:
            about, along = push(k * step_s)
            force.write(messaging.CmdForceBodyMsgPayload(forceRequestBody=list(along)), k)
            torque.write(messaging.CmdTorqueBodyMsgPayload(torqueRequestBody=list(about)), k)

    command(0)
    simulation.InitializeSimulation()
    rows = []
    for k in range(int(round(duration_s / step_s)) + 1):
        # The task at time k integrates the step that ends there, by what was commanded at its start.
        simulation.ConfigureStopTime(macros.sec2nano(k * step_s))
        simulation.ExecuteSimulation()
        state = craft.scStateOutMsg.read()
        speeds = rotor.rwSpeedOutMsg.read().wheelSpeeds[: len(wheels)] if wheels else []
        rows.append(np.concatenate([state.sigma_BN, state.r_BN_N, state.omega_BN_B, state.v_BN_N, speeds]))
        command(k)
    rows = np.array(rows)
    s = rows[:, :3]
    square = np.sum(s * s, axis=1, keepdims=True)
    attitude = np.concatenate([2 * s, 1 - square], axis=1) / (1 + square)
    return [attitude, rows[:, 3:6], rows[:, 6:9], rows[:, 9:12]], rows[:, 12:]


def point(mass, at):
    s = motion.cross_matrix(at)
    return -mass * s @ s


def joined(hub, other):
    """Hub and appendage at rest as one rigid body."""
    mass = hub[0] + other[0]
    centre = (hub[0] * hub[1] + other[0] * other[1]) / mass
    about = hub[2] + point(hub[0], hub[1] - centre) + other[2] + point(other[0], other[1] - centre)
    return mass, centre, about


def panel():
    """A panel on a hinge with a spring: its state effector, mass properties in B, lines of the model."""
    from Basilisk.simulation import hingedRigidBodyStateEffector

    mass, distance, stiffness, damping = 12.0, 1.1, 120.0, 0.6
    hinge, about = np.array([0.1, 0.9, 0.2]), np.diag([0.4, 5.0, 5.4])
    # H: first axis towards the body (-y), second along the hinge (x).
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    effector = hingedRigidBodyStateEffector.HingedRigidBodyStateEffector()
    effector.ModelTag, effector.mass, effector.d, effector.k, effector.c = "panel", mass, distance, stiffness, damping
    effector.IPntS_S, effector.r_HB_B, effector.dcm_HB = about.tolist(), [[x] for x in hinge], turned.tolist()
    arm = -distance * turned[0]
    inertia = turned.T @ about @ turned
    text = (
        f'[[panel]]\nname = "panel"\nbody = "b0"\nhinge_m = {families.text(hinge)}\naxis = {families.text(turned[1])}\n'
        f"mass_kg = {mass}\ncom_m = {families.text(arm)}\n"
        f"inertia_kg_m2 = {{ xx = {inertia[0, 0]}, yy = {inertia[1, 1]}, zz = {inertia[2, 2]}, xy = 0.0, xz = 0.0, yz = 0.0 }}\n"
        f"stiffness_N_m_per_rad = {stiffness}\ndamping_N_m_s_per_rad = {damping}\n\n"
    )
    return effector, (mass, hinge + arm, inertia), text


def slosh():
    """Propellant on a spring along one axis."""
    from Basilisk.simulation import linearSpringMassDamper

    mass, stiffness, damping, at, along = 25.0, 150.0, 1.3, np.array([0.3, 0.2, -0.5]), np.array([0.0, 1.0, 0.0])
    effector = linearSpringMassDamper.LinearSpringMassDamper()
    effector.k, effector.c, effector.massInit, effector.rhoInit, effector.rhoDotInit = stiffness, damping, mass, 0.0, 0.0
    effector.r_PB_B, effector.pHat_B = [[x] for x in at], [[x] for x in along]
    text = (
        f'[[tank]]\nname = "tank"\nbody = "b0"\nposition_m = {families.text(at)}\nmass_kg = {mass}\n'
        f"stiffness_N_per_m = {stiffness}\ndamping_N_s_per_m = {damping}\naxis = {families.text(along)}\n\n"
    )
    return effector, (mass, at, np.zeros((3, 3))), text


def basilisk_wheels(family, appendage=None):
    """Three wheels under motor torques; with a panel or sloshing propellant the body contains it, undeformed."""
    draw, count, step_s = family.draw, len(family.seeds), 0.1
    hub = tuple(x[0] for x in families.bus(draw, 150.0, 400.0))
    effector, extra, lines = {None: lambda: (None, None, ""), "panel": panel, "slosh": slosh}[appendage]()
    whole = joined(hub, extra) if extra else hub
    copies = tuple(np.broadcast_to(x, (count, *np.shape(x))).copy() for x in whole)
    family.bodies([copies], {0: '["inertia"]'})
    wheels = [(0, a, np.full(count, 0.05)) for a in families.axes(3, draw)]
    families.wheel_texts(family, wheels)
    family.write(lambda k: lines)
    curve = families.Curve(draw, 3, 150.0, (30.0, 150.0))
    torques = lambda t: 0.05 * curve.slope(t)[0]
    turn, rates = draw.turn()[0], 0.003 * draw.normal(3)[0]
    spun = [(axis[0], 0.05) for _, axis, _ in wheels]
    moved, speeds = basilisk(hub, (turn * np.sign(turn[3]), rates), 300.0, step_s, spun, torques, appendage=effector)
    # Motor torques are held over a step, so that speeds are almost linear in it.
    change = np.gradient(speeds, step_s, axis=0)
    sampled, one = Sampled(step_s, speeds, change, count), Sampled(step_s, speeds, change, 1)
    at = families.grid(300.0, 10.0)
    inputs = lambda t: (np.zeros((1, 0)), np.zeros((1, 0)), one.value(t))
    single = motion.Vehicle(first([copies]), (), first(wheels))
    flight = Flight(single, inputs, begin_of(moved), at, step_s)
    attitude, _, rates, _ = take(family, flight, moved, (2e-5, 5e-5))
    flight.rigid_only = appendage is not None
    families.wheels(family, at, sampled, 0.02)
    families.gyro(family, at, rates, 2e-5)
    families.tracker(family, at[::5], attitude[:, ::5], 5e-5)


def begin_of(moved):
    attitude, place, rates, velocity = (x[:1] for x in moved)
    back = motion.times(np.swapaxes(motion.matrix(attitude), -1, -2), velocity)
    return attitude, place, np.concatenate([rates, back], axis=-1)


def basilisk_thrusters(family):
    """Twelve thrusters, all ten numbers of one body, position and velocity read."""
    draw, step_s = family.draw, 0.1
    body = families.bus(draw, 150.0, 400.0)
    seats, directions = families.thruster_seats(draw)
    pulses = families.Pulses(draw, seats, directions, 4.0, 30, (1.0, 4.0), 300.0, step_s)
    family.bodies([body], {0: "true"})
    families.thruster_texts(family, seats, directions)
    push = lambda t: tuple(x[0] for x in pulses.wrench(t))
    turn, rates = draw.turn()[0], 0.003 * draw.normal(3)[0]
    hub = tuple(x[0] for x in body)
    moved, _ = basilisk(hub, (turn * np.sign(turn[3]), rates), 300.0, step_s, push=push)
    at = families.grid(300.0, 10.0)
    none = np.zeros((1, 0))
    wrench = lambda t: tuple(x[:1] for x in pulses.wrench(t))
    flight = Flight(motion.Vehicle(first([body])), lambda t: (none, none, none), begin_of(moved), at, step_s, wrench)
    attitude, place, rates, velocity = take(family, flight, moved, (2e-5, 5e-5))
    families.fired(family, pulses)
    families.gyro(family, at, rates, 2e-5)
    families.tracker(family, at[::5], attitude[:, ::5], 5e-5)
    families.vector(family, "position", "pos", at[::10], place[:, ::10], "m", 0.1)
    families.vector(family, "velocity", "vel", at[::10], velocity[:, ::10], "m_s", 2e-3)
