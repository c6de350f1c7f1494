"""A vehicle with its flight and the noise of every seed: what the table of vehicles and the engines are made of."""

import pathlib
import sys
import zlib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "families"))
import families
import motion


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
