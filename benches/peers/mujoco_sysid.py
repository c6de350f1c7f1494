#!/usr/bin/env python3
"""MuJoCo's identification toolbox on a payload at the end of a free-floating arm, and the same readings for Poinsot.

    python3 mujoco_sysid.py FOLDER            write FOLDER/telemetry.csv
    python3 mujoco_sysid.py FOLDER --fit      and identify with mujoco.sysid, three times

A base of 400 kg, four joints, an unknown payload of 60 kg, all else known; 30 s at 50 Hz. The toolbox needs the joint
torques and the initial state; both are given exactly, then 2 % and 1e-4 rad/s off. Needs mujoco[sysid]==3.8.1: the
wheels 3.17 and 4.0 raise an error for a full inertia. Prints name,value,unit.
"""
import logging
import pathlib
import resource
import sys
import time

import mujoco
import numpy as np

STEP, DURATION = 0.02, 30.0
LINKS = [  # name, place in the parent, joint axis, mass centre, mass, diagonal of the central inertia
    ("link1", (0.5, 0, 0.4), (0, 0, 1), (0, 0, 0.15), 12, (0.51, 0.51, 0.2)),
    ("link2", (0, 0, 0.3), (0, 1, 0), (0.5, 0, 0), 10, (0.1, 1.8, 1.7)),
    ("link3", (1, 0, 0), (0, 1, 0), (0.4, 0, 0), 10, (0.1, 1.2, 1.2)),
]
TRUTH = np.array([60, 0.20, 0.05, -0.08, 6, 7, 8, 0.3, -0.2, 0.4])  # mass, mass centre, xx yy zz xy xz yz
NOISE = {"gyro": 1e-4, "attitude": 2e-5, "angle": 1e-5, "rate": 1e-4}


def words(numbers):
    return " ".join(f"{x:g}" for x in numbers)


def payload(numbers):
    return f'<inertial pos="{words(numbers[1:4])}" mass="{numbers[0]:g}" fullinertia="{words(numbers[4:])}"/>'


def document(numbers):
    inner = f'<body name="payload" pos="0.8 0 0"><joint name="joint4" axis="1 0 0"/>{payload(numbers)}</body>'
    for k, (name, place, axis, centre, mass, inertia) in reversed(list(enumerate(LINKS))):
        inner = (
            f'<body name="{name}" pos="{words(place)}"><joint name="joint{k + 1}" axis="{words(axis)}"/>'
            f'<inertial pos="{words(centre)}" mass="{mass}" diaginertia="{words(inertia)}"/>{inner}</body>'
        )
    joints = [f"joint{k}" for k in range(1, 5)]
    motors = "".join(f'<motor name="motor_{j}" joint="{j}"/>' for j in joints)
    sensors = "".join(f'<jointpos name="q_{j}" joint="{j}"/>' for j in joints)
    sensors += "".join(f'<jointvel name="v_{j}" joint="{j}"/>' for j in joints)
    return (
        f'<mujoco><option gravity="0 0 0" timestep="{STEP}" integrator="RK4"/><worldbody><body name="base">'
        '<freejoint name="root"/><inertial pos="0.01 -0.02 0.03" mass="400" fullinertia="30 28 32 0.26 0.37 -0.29"/>'
        f'<site name="imu"/>{inner}</body></worldbody><actuator>{motors}</actuator><sensor>'
        '<gyro name="gyro" site="imu"/><framequat name="attitude" objtype="site" objname="imu"/>'
        f"{sensors}</sensor></mujoco>"
    )


def motion(model):
    """Torques of a slow reach of all joints, and what exact sensors read."""
    data = mujoco.MjData(model)
    times = np.arange(int(DURATION / STEP)) * STEP
    size, turn = np.deg2rad([25, 20, 25, 30]), 2 * np.pi * np.array([0.05, 0.07, 0.09, 0.11])
    torque, read = np.zeros((len(times), 4)), []
    for k, t in enumerate(times):
        wanted, rate = size * (1 - np.cos(turn * t)), size * turn * np.sin(turn * t)
        torque[k] = np.array([60, 60, 60, 40]) * (wanted - data.qpos[7:])
        torque[k] += np.array([120, 120, 100, 60]) * (rate - data.qvel[6:])
        data.ctrl[:] = torque[k]
        mujoco.mj_step(model, data)
        read.append(data.sensordata.copy())
    return times, torque, np.array(read)


def noisy(exact, seed=0):
    rng, out = np.random.default_rng(seed), exact.copy()
    for columns, name in [(slice(0, 3), "gyro"), (slice(3, 7), "attitude"), (slice(7, 11), "angle"), (slice(11, 15), "rate")]:
        out[:, columns] += NOISE[name] * rng.standard_normal(out[:, columns].shape)
    return out


def write(folder, times, readings):
    names = ["omega_x", "omega_y", "omega_z", "q_w", "q_x", "q_y", "q_z"]
    names += [f"joint{k}_rad" for k in range(1, 5)] + [f"joint{k}_rad_s" for k in range(1, 5)]
    readings = readings.copy()
    readings[:, 3:7] /= np.linalg.norm(readings[:, 3:7], axis=1)[:, None]
    rows = np.column_stack([times, readings])
    header = ",".join(["time_s"] + names)
    np.savetxt(folder / "telemetry.csv", rows, delimiter=",", header=header, comments="", fmt="%.17g")


def properties(theta):
    from mujoco import sysid

    pi = np.asarray(sysid.model_modifier.pi_from_theta(np.asarray(theta)))
    mass, centre = pi[0], pi[1:4] / pi[0]
    turn = np.cross(np.eye(3), centre)
    central = pi[4:].reshape(3, 3) + mass * turn @ turn
    return np.r_[mass, centre, np.diag(central), central[0, 1], central[0, 2], central[1, 2]]


def fit(name, times, torque, readings, rate=0.0):
    from mujoco import sysid

    spec = mujoco.MjSpec.from_string(document(TRUTH))
    body = spec.body("payload")
    body.mass, body.ipos, body.fullinertia = 30, [0.1, 0, 0], [3, 3, 3, 0, 0, 0]
    model = spec.compile()
    unknown = sysid.ParameterDict()
    kind = sysid.InertiaType.Pseudo
    limits = {"stretch_bound_mult": np.array([0.02, 50]), "shear_bound_off": np.array([-3, 3])}
    unknown.add(sysid.body_inertia_param(spec, model, "payload", inertia_type=kind, **limits))
    speed = np.zeros(model.nv)
    speed[3:6] = rate * np.array([1, -1, 1])
    start = sysid.create_initial_state(model, model.qpos0.copy(), speed)
    control = sysid.TimeSeries.from_control_names(times, torque, model)
    measured = sysid.TimeSeries.from_names(times + STEP, readings, model)
    sequences = sysid.ModelSequences("payload", spec, "reach", start, control, measured)
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    began, busy = time.perf_counter(), processor()
    found, _ = sysid.optimize(
        initial_params=unknown, residual_fn=residual, optimizer="scipy_parallel_fd", verbose=False, x_scale="jac"
    )
    seconds = time.perf_counter() - began
    print(f"mujoco_sysid_{name}_processor,{processor() - busy:.3f},s")
    answer = properties(found["payload_inertia"].value)
    report(f"mujoco_sysid_{name}", seconds, answer)


def processor():
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(u.ru_utime + u.ru_stime for u in used)


def report(name, seconds, answer):
    print(f"{name},{seconds:.3f},s")
    print(f"{name}_mass_error,{100 * abs(answer[0] / TRUTH[0] - 1):.4f},%")
    print(f"{name}_com_error,{1e3 * np.linalg.norm(answer[1:4] - TRUTH[1:4]):.3f},mm")
    print(f"{name}_moments_error,{100 * np.abs(answer[4:7] / TRUTH[4:7] - 1).max():.3f},%")
    print(f"{name}_products_error,{100 * np.abs(answer[7:] / TRUTH[7:] - 1).max():.2f},%", flush=True)


def main():
    folder = pathlib.Path(sys.argv[1])
    model = mujoco.MjSpec.from_string(document(TRUTH)).compile()
    times, torque, exact = motion(model)
    readings = noisy(exact)
    write(folder, times, readings)
    if "--fit" in sys.argv:
        logging.disable(logging.CRITICAL)
        fit("exact_torque", times, torque, readings)
        fit("torque_2_percent_off", times, 1.02 * torque, readings)
        fit("initial_rate_1e-4_off", times, torque, readings, rate=1e-4)


main()
