"""The 24 vehicles: each is drawn once, flown once without noise, and read by its sensors with the noise of every seed.

Eighteen are flown by the NumPy simulator of `validation/families`, two by MuJoCo and four by Basilisk (`engines.py`). A vehicle, its
nominal numbers and its motion depend on its name alone; sensor noise and gyro bias depend on name and seed."""

import pathlib
import sys
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "families"))
import families
import motion

import engines

FILES = {"gyro": "gyro", "attitude": "st", "position": "pos", "velocity": "vel"}


class Once(families.Draw):
    """The same numbers for all seeds until `noise`, then numbers of each seed."""

    def __init__(self, name, seeds):
        self.key, self.seeds = zlib.crc32(name.encode()), list(seeds)
        self.all = [np.random.default_rng([self.key]) for _ in self.seeds]

    def noise(self):
        self.all = [np.random.default_rng([self.key, 1 + seed]) for seed in self.seeds]


class Flight:
    """What was flown without noise: one vehicle (arrays of one copy), its inputs over time, start, and the motion at `times_s`:
    attitude [T, 4] N from B, place [T, 3] of the base's origin in N, rates [T, 3] in B, velocity [T, 3] in N."""

    def __init__(self, vehicle, inputs, start, times_s, step_s, wrench=None, torque=None):
        self.vehicle, self.inputs, self.start = vehicle, inputs, start
        self.times_s, self.step_s, self.wrench, self.torque = np.asarray(times_s), step_s, wrench, torque
        flown = motion.fly(vehicle, inputs, start, times_s, step_s, wrench, torque)
        self.attitude, self.place, self.rates, self.velocity = (x[0] for x in flown)
        self.rigid_only = False


def first(parts):
    return [tuple(x if isinstance(x, int) else x[:1] for x in part) for part in parts]


class Benchmark(families.Family):
    """A family whose seeds share one vehicle."""

    def __init__(self, name, seeds):
        super().__init__(name, seeds)
        self.draw = Once(name, seeds)

    def fly(self, vehicle, inputs, start, times_s, step_s, wrench=None, torque=None):
        """Stands for `families.fly`: flies the first of the equal copies, and starts the noise."""
        one = motion.Vehicle(first(vehicle.bodies), first(vehicle.joints), first(vehicle.wheels))
        pushed = None if wrench is None else lambda t: tuple(x[:1] for x in wrench(t))
        moved = lambda t: tuple(x[:1] for x in inputs(t))
        self.set_flight(Flight(one, moved, tuple(x[:1] for x in start), times_s, step_s, pushed, torque))
        return self.copies(self.flight)

    def set_flight(self, flight):
        self.flight = flight
        self.draw.noise()

    def copies(self, flight):
        every = (flight.attitude, flight.place, flight.rates, flight.velocity)
        return [np.broadcast_to(x, (len(self.seeds), *x.shape)).copy() for x in every]

    def numbers(self):
        """Names of the numbers that are asked for, in the order of `true_values`."""
        names = []
        for body, groups in self.unknown.items():
            names += [f"b{body}.mass_kg"] * (groups == "true")
            names += [f"b{body}.com_m.{a}" for a in "xyz"] * (groups == "true")
            names += [f"b{body}.inertia_kg_m2.{e}" for e in families.ELEMENTS]
        return names

    def true_values(self):
        return np.concatenate([values_of(tuple(x[0] for x in self.truth[b]), g) for b, g in self.unknown.items()])


def values_of(body, groups):
    mass, centre, about = body
    elements = [about[at] for at in families.ELEMENTS.values()]
    return np.array([mass, *centre, *elements] if groups == "true" else elements)


def body_with(body, groups, values):
    """The body with other values: inverse of `values_of`."""
    elements = values[4:] if groups == "true" else values
    about = np.zeros((3, 3))
    for (i, j), x in zip(families.ELEMENTS.values(), elements):
        about[i, j] = about[j, i] = x
    return (values[0], values[1:4], about) if groups == "true" else (body[0], body[1], about)


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
