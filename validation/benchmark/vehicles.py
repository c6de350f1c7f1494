"""The 24 vehicles: each is drawn once, flown once without noise, and read by its sensors with the noise of every seed.

Eighteen are flown by the NumPy simulator of `validation/families`, two by MuJoCo and four by Basilisk (`engines.py`). A vehicle, its
nominal numbers and its motion depend on its name alone; sensor noise and gyro bias depend on name and seed."""

import numpy as np

import engines
from flight import Benchmark, families, motion

FILES = {"gyro": "gyro", "attitude": "st", "position": "pos", "velocity": "vel"}


def one_axis(family, axis):
    """Slews from rest about one axis of the body alone: only the tensor times that axis acts."""
    draw = family.draw
    body = families.bus(draw)
    spin = np.full(len(family.seeds), 0.05)
    wheels = [(0, a, spin) for a in families.axes(3, draw)]
    family.bodies([body], {0: '["inertia"]'})
    families.wheel_texts(family, wheels)
    rate = families.Curve(draw, 1, 0.02, (60.0, 200.0))
    along = body[2] @ np.array(axis) / spin[:, None]

    class Speeds:
        def value(self, t):
            return -along * (rate.value(t) - rate.value(0.0))

    still, speeds = families.Still(draw), Speeds()
    inputs = lambda t: (still.value(t), still.slope(t), speeds.value(t))
    at = families.grid(300.0, 10.0)
    vehicle = motion.Vehicle([body], (), wheels)
    attitude, _, rates, _ = family.fly(vehicle, inputs, families.start(draw, 0.0), at, 0.1)
    families.wheels(family, at, speeds, 0.02)
    families.gyro(family, at, rates, 2e-5)
    families.tracker(family, at[::5], attitude[:, ::5], 5e-5)


ALL = "true"
VEHICLES = {
    "wheels": families.FAMILIES["wheels_q0.3"],
    "wheels_noisy": families.FAMILIES["wheels_q5"],
    "pyramid": families.FAMILIES["pyramid_biased"],
    "no_gyro": families.FAMILIES["no_gyro"],
    "gyro_walk": families.FAMILIES["gyro_walk"],
    "tracker_slow": families.FAMILIES["tracker_slow"],
    "one_axis": lambda f: one_axis(f, [0.0, 0.0, 1.0]),
    # The direction of the slew of Kim, Choi and Oh 2010: not one of six numbers is known.
    "one_axis_tilted": lambda f: one_axis(f, [0.5407, 0.6444, 0.5407]),
    "spinner": families.FAMILIES["spinner_5rpm"],
    "cmg_pyramid": families.FAMILIES["cmg_pyramid"],
    "dual_spin": families.FAMILIES["dual_spin"],
    "thrusters": families.FAMILIES["thrusters_gps0.1"],
    "target_3_joints": families.FAMILIES["arm3"],
    "target_6_joints": families.FAMILIES["arm6"],
    "target_two_arms": families.FAMILIES["arms_two"],
    "target_1_joint": lambda f: families.arm(f, 1),
    "base_by_arm": lambda f: families.arm(f, 3, unknown={0: ALL}),
    "base_and_target": lambda f: families.arm(f, 3, unknown={0: ALL, 3: ALL}),
    "mujoco_target": lambda f: engines.mujoco_arm(f, 3, {3: ALL}),
    "mujoco_base": lambda f: engines.mujoco_arm(f, 2, {0: ALL}),
    "basilisk_wheels": engines.basilisk_wheels,
    "basilisk_thrusters": engines.basilisk_thrusters,
    "basilisk_panel": lambda f: engines.basilisk_wheels(f, "panel"),
    "basilisk_slosh": lambda f: engines.basilisk_wheels(f, "slosh"),
}


def build(name, seeds):
    """The vehicle of a name with its records of some seeds, in memory."""
    family = Benchmark(name, seeds)
    own, families.fly = families.fly, family.fly
    try:
        VEHICLES[name](family)
    finally:
        families.fly = own
    return family
