#!/usr/bin/env python3
"""Honest records of many kinds of vehicle, identified and scored: which are answered, and how far their numbers are off.

    families.py [--seeds N] [--first K] [--only WORD] [--out FOLDER] [--poinsot PROGRAM] [--jobs N] [--check] [--quiet]

Vehicles, motion and noise are drawn here and integrated by `motion.py`; nothing is shared with what is judged. Nominal numbers are
drawn 10 % off, everything else is declared as it is. A line for each family: share answered (exit code 0), and of the answered
records the mean and the root mean square of (estimate - truth) / sigma, the share within 1.96 sigma, the mean square of all numbers
by their covariance (NEES) with its chance, and the largest with its record; then the same of all. Records that the same program has
identified stay. `--check` fails where a calibrated estimator that answers 97 % of all and 85 % of each family would do so once in a
thousand times, or a number is 5 sigma off. `--quiet` takes records that tell little and have nothing wrong (at rest, slow, fast,
coarse gyros) instead, and counts those that are refused, called contradicted or not converged, or trusted with a number 5 sigma off."""

import argparse
import concurrent.futures
import hashlib
import json
import math
import pathlib
import subprocess
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from motion import Swinging, Vehicle, cross_matrix, exponential, fly, matrix, product, swing, times

ROOT = pathlib.Path(__file__).resolve().parents[2]
ELEMENTS = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
GRAVITY = 3.986004418e14


class Draw:
    """Random numbers of some vehicles, each with a generator of its own: a vehicle does not change with their number."""

    def __init__(self, family, seeds):
        self.all = [np.random.default_rng([sum(family.encode()), seed]) for seed in seeds]

    def normal(self, *shape):
        return np.stack([r.normal(size=shape) for r in self.all])

    def uniform(self, low, high, *shape):
        return np.stack([r.uniform(low, high, size=shape) for r in self.all])

    def direction(self):
        v = self.normal(3)
        return v / np.linalg.norm(v, axis=-1, keepdims=True)

    def turn(self):
        q = self.normal(4)
        return q / np.linalg.norm(q, axis=-1, keepdims=True)


def tensor(draw, size):
    """Of a box with edges drawn about a size [S], turned at random by some tenths; over mass."""
    a, b, c = np.moveaxis((size[:, None] * draw.uniform(0.7, 1.4, 3)) ** 2, -1, 0)
    plain = np.zeros((len(size), 3, 3))
    plain[:, 0, 0], plain[:, 1, 1], plain[:, 2, 2] = (b + c) / 12, (a + c) / 12, (a + b) / 12
    turned = matrix(exponential(0.4 * draw.normal(3)))
    return turned @ plain @ np.swapaxes(turned, -1, -2)


def bus(draw, low=100.0, high=800.0):
    mass = draw.uniform(low, high)
    return mass, 0.1 * draw.normal(3), mass[:, None, None] * tensor(draw, 1.2 + mass / 600.0)


def off(draw, body, share=0.1):
    """Nominal numbers of a body, as far off as that."""
    mass, centre, about = body
    stretch = np.eye(3) + 0.5 * share * draw.normal(3, 3)
    nominal = stretch @ about @ np.swapaxes(stretch, -1, -2)
    return mass * (1 + share * draw.normal()), centre + 0.03 * draw.normal(3), nominal


class Curve:
    """A sum of sines for each of some inputs: value and rate."""

    def __init__(self, draw, count, reach, periods_s, base=0.0, tones=3):
        self.reach = reach * draw.uniform(0.4, 1.0, count, tones) / tones
        self.rate = 2 * np.pi / draw.uniform(*periods_s, count, tones)
        self.phase = draw.uniform(0, 2 * np.pi, count, tones)
        self.base = base + 0 * self.reach[..., 0]

    def value(self, t):
        return self.base + np.sum(self.reach * np.sin(self.rate * t + self.phase), axis=-1)

    def slope(self, t):
        return np.sum(self.reach * self.rate * np.cos(self.rate * t + self.phase), axis=-1)


class Still:
    def __init__(self, draw, count=0, value=0.0):
        self.all = np.full((len(draw.all), count), value)

    def value(self, _):
        return self.all

    def slope(self, _):
        return 0 * self.all


class Turning:
    """One joint at a constant rate."""

    def __init__(self, rate):
        self.rate = np.asarray(rate)[:, None]

    def value(self, t):
        return self.rate * t

    def slope(self, _):
        return self.rate


class Pulses:
    """Firings one after the other, each of one thruster: force direction and place in B, on and off times."""

    def __init__(self, draw, seats, directions, force, count, length_s, within_s, step_s):
        self.seats, self.directions, self.force = seats, directions, force
        self.which = np.stack([r.integers(seats.shape[1], size=count) for r in draw.all])
        slot = within_s / count
        start = draw.uniform(0.1, 0.9, count) * (slot - length_s[1]) + slot * np.arange(count)
        # On the grid of the integration: a step never crosses a switch.
        self.on = step_s * np.round(start / step_s)
        self.off = self.on + step_s * np.round(draw.uniform(*length_s, count) / step_s)

    def at(self, t):
        on = ((self.on <= t + 1e-9) & (t + 1e-9 < self.off)).astype(float)
        force = np.zeros(self.seats.shape[:2])
        for k in range(self.which.shape[1]):
            np.add.at(force, (np.arange(len(force)), self.which[:, k]), on[:, k])
        return force * self.force

    def wrench(self, t):
        push = self.at(t)[..., None] * self.directions
        return np.sum(np.cross(self.seats, push), axis=1), np.sum(push, axis=1)


def text(values):
    return "[" + ", ".join(f"{x:.15g}" for x in values) + "]"


def body_text(name, body, k, estimate=None):
    mass, centre, about = (x[k] for x in body)
    elements = ", ".join(f"{e} = {about[i, j]:.15g}" for e, (i, j) in ELEMENTS.items())
    lines = [f'[[body]]\nname = "{name}"\nmass_kg = {mass:.15g}\ncom_m = {text(centre)}\ninertia_kg_m2 = {{ {elements} }}']
    return "\n".join(lines + ([f"estimate = {estimate}"] if estimate else [])) + "\n\n"


def sensor_text(name, kind, **keys):
    lines = [f'[[sensor]]\nname = "{name}"\ntype = "{kind}"']
    return "\n".join(lines + [f"{key} = {value}" for key, value in keys.items()]) + "\n\n"


class Family:
    """Vehicles of one kind, their records and model files."""

    def __init__(self, name, seeds):
        self.name, self.seeds = name, list(seeds)
        self.draw = Draw(name, seeds)
        self.model = [f'schema = "poinsot.model/1"\nname = "{name}"\nexact = true\n\n' for _ in seeds]
        self.tables = [[] for _ in seeds]

    def write(self, of):
        """`of(k)`: lines for the model of vehicle k."""
        self.model = [m + of(k) for k, m in enumerate(self.model)]

    def bodies(self, bodies, unknown):
        """`unknown`: what is estimated, by body."""
        self.unknown, self.truth = unknown, bodies
        for b, body in enumerate(bodies):
            shown = off(self.draw, body) if b in unknown else body
            if unknown.get(b) == '["inertia"]':
                shown = (*body[:2], shown[2])
            self.write(lambda k, b=b, shown=shown: body_text(f"b{b}", shown, k, unknown.get(b)))

    def column(self, name, times_s, names, values):
        """A file of some columns; values [S, T, n]."""
        for k, table in enumerate(self.tables):
            table.append((name, times_s, names, values[k]))


def gyro(family, times_s, rates, sigma, walk=0.0, step=0.0):
    draw, n = family.draw, len(times_s)
    bias = 2e-4 * draw.normal(1, 3)
    h = times_s[1] - times_s[0]
    drift = walk * np.sqrt(h) * np.cumsum(draw.normal(n, 3), axis=1)
    read = rates + bias + drift + sigma * draw.normal(n, 3)
    keys = {"noise_rad_s": sigma, "bias": '"estimate"'}
    if walk:
        keys["walk_rad_s_s05"] = walk
    if step:
        read, keys["quantisation_rad_s"] = np.round(read / step) * step, step
    family.write(lambda k: sensor_text("gyro", "gyro", **keys))
    family.column("gyro", times_s, ["omega_x", "omega_y", "omega_z"], read)


def tracker(family, times_s, attitude, sigma, slow=0.0, correlation_s=0.0):
    draw, n = family.draw, len(times_s)
    error = sigma * draw.normal(n, 3)
    keys = {"noise_rad": sigma}
    if slow:
        stays = np.exp(-(times_s[1] - times_s[0]) / correlation_s)
        last = draw.normal(n, 3)
        for i in range(1, n):
            last[:, i] = stays * last[:, i - 1] + np.sqrt(1 - stays * stays) * last[:, i]
        error, keys = error + slow * last, keys | {"slow_rad": slow, "correlation_s": correlation_s}
    family.write(lambda k: sensor_text("st", "attitude", **keys))
    family.column("st", times_s, ["q_x", "q_y", "q_z", "q_w"], product(attitude, exponential(error)))


def direction(family, name, times_s, attitude, reference, sigma):
    draw = family.draw
    seen = np.einsum("stji,sj->sti", matrix(attitude), reference)
    error = sigma * draw.normal(len(times_s), 3)
    seen = seen + np.cross(error, seen)
    seen = seen / np.linalg.norm(seen, axis=-1, keepdims=True)
    family.write(lambda k: sensor_text(name, "direction", noise_rad=sigma, reference_N=text(reference[k])))
    family.column(name, times_s, [f"{name}.d_{x}" for x in "xyz"], seen)


def vector(family, kind, name, times_s, values, unit, sigma):
    family.write(lambda k: sensor_text(name, kind, **{f"noise_{unit}": sigma}))
    letter = {"position": "r", "velocity": "v"}[kind]
    names = [f"{letter}_{x}" for x in "xyz"]
    family.column(name, times_s, names, values + sigma * family.draw.normal(len(times_s), 3))


def wheels(family, times_s, curve, sigma):
    sigma = np.broadcast_to(sigma, (len(family.seeds),))
    values = np.stack([curve.value(t) for t in times_s], axis=1)
    values = values + sigma[:, None, None] * family.draw.normal(*values.shape[1:])
    family.write(lambda k: sensor_text("tach", "wheel_speed", noise_rad_s=f"{sigma[k]:.15g}"))
    family.column("rw", times_s, [f"wheel{w + 1}_rad_s" for w in range(values.shape[2])], values)


def encoders(family, times_s, curve, sigma, rate_sigma=None, step=0.0):
    values = np.stack([curve.value(t) for t in times_s], axis=1)
    read = values + sigma * family.draw.normal(*values.shape[1:])
    keys = {"noise_rad": sigma}
    if step:
        read, keys["quantisation_rad"] = np.round(read / step) * step, step
    family.write(lambda k: sensor_text("enc", "joint_position", **keys))
    names = [f"joint{j + 1}" for j in range(values.shape[2])]
    family.column("enc", times_s, [f"{name}_rad" for name in names], read)
    if rate_sigma:
        rates = np.stack([curve.slope(t) for t in times_s], axis=1)
        rates = rates + rate_sigma * family.draw.normal(*rates.shape[1:])
        family.write(lambda k: sensor_text("rate", "joint_rate", noise_rad_s=rate_sigma))
        family.column("rate", times_s, [f"{name}_rad_s" for name in names], rates)


def rotation_text(m):
    """Quaternion (x, y, z, w) of a rotation matrix."""
    values, vectors = np.linalg.eigh(
        np.array(
            [
                [m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2], m[2, 1] - m[1, 2]],
                [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
                [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
                [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]],
            ]
        )
    )
    return text(vectors[:, np.argmax(values)])


def joint_texts(family, joints, spring=lambda k, j: ""):
    for j, (parent, at, seat, axis) in enumerate(joints):
        family.write(
            lambda k, j=j, parent=parent, at=at, seat=seat, axis=axis: (
                f'[[joint]]\nname = "joint{j + 1}"\ntype = "revolute"\nparent = "b{parent}"\nchild = "b{j + 1}"\n'
                f"origin_m = {text(at[k])}\nrotation_xyzw = {rotation_text(seat[k])}\naxis = {text(axis[k])}\n{spring(k, j)}\n"
            )
        )


def sprung(family, joints, springs, unknown=False):
    """Joints that springs move; `unknown`: stiffness and damping are, with nominal numbers 10 and 50 % off."""
    stiffness, damping, rest = springs
    shown = (stiffness, damping)
    if unknown:
        draw = family.draw
        count = stiffness.shape[1]
        shown = (stiffness * (1 + 0.1 * draw.normal(count)), damping * np.exp(0.5 * draw.normal(count)))

    def spring(k, j):
        keys = f"stiffness_N_m_per_rad = {shown[0][k, j]:.15g}, damping_N_m_s_per_rad = {shown[1][k, j]:.15g}"
        keys += f", rest_rad = {rest[k, j]:.15g}"
        return f"spring_damper = {{ {keys}" + (', estimate = ["stiffness", "damping"]' if unknown else "") + " }\n"

    joint_texts(family, joints, spring)


def held(inertia, draw, low_Hz, high_Hz, ratio):
    """Stiffness and damping of joints that carry these inertias, with a share of the critical damping."""
    omega = 2 * np.pi * draw.uniform(low_Hz, high_Hz, inertia.shape[1])
    return inertia * omega**2, 2 * ratio * inertia * omega


def wheel_texts(family, all):
    for w, (body, axis, spin) in enumerate(all):
        family.write(
            lambda k, w=w, body=body, axis=axis, spin=spin: (
                f'[[wheel]]\nname = "wheel{w + 1}"\nbody = "b{body}"\naxis = {text(axis[k])}\nspin_inertia_kg_m2 = {spin[k]:.15g}\n\n'
            )
        )


def thruster_texts(family, seats, directions, extra=""):
    for j in range(seats.shape[1]):
        family.write(
            lambda k, j=j: (
                f'[[thruster]]\nname = "thr{j + 1}"\nbody = "b0"\nposition_m = {text(seats[k, j])}\n'
                f"force_direction = {text(directions[k, j])}\n{extra}\n"
            )
        )


def fired(family, pulses):
    for k, table in enumerate(family.tables):
        switches = np.unique(np.concatenate([[0.0], pulses.on[k], pulses.off[k]]))
        force = np.stack([pulses.at(t)[k] for t in switches])
        table.append(("thr", switches, [f"thr{j + 1}_N" for j in range(force.shape[1])], force))


def axes(count, draw):
    unit = np.eye(3)[[0, 1, 2]] if count == 3 else np.array([[1, 1, 1], [-1, 1, 1], [-1, -1, 1], [1, -1, 1]]) / np.sqrt(3)
    return [np.broadcast_to(a, (len(draw.all), 3)) for a in unit]


def grid(duration_s, rate_hz):
    return np.arange(int(duration_s * rate_hz) + 1) / rate_hz


def start(draw, rate, drift=0.0):
    return draw.turn(), np.zeros((len(draw.all), 3)), np.concatenate([rate * draw.normal(3), drift * draw.normal(3)], axis=-1)


def with_wheels(family, duration_s=300.0, q=0.3, gyro_sigma=2e-5, sensors=None, **more):
    """One body with three or four wheels; `q`: noise of the wheels, as rates of the body, over that of the gyro."""
    draw = family.draw
    body = bus(draw)
    least = np.linalg.eigvalsh(body[2])[:, 0]
    spin = least * draw.uniform(3e-4, 8e-4)
    all = [(0, a, spin) for a in axes(more.pop("wheels", 3), draw)]
    curve = Curve(draw, len(all), 100.0, (60.0, 200.0), base=more.pop("base", 0.0))
    family.bodies([body], {0: '["inertia"]'})
    wheel_texts(family, all)
    at = grid(duration_s, 10.0)
    vehicle = Vehicle([body], (), all)
    still = Still(draw)
    inputs = lambda t: (still.value(t), still.slope(t), curve.value(t))
    attitude, place, rates, velocity = fly(vehicle, inputs, start(draw, more.pop("rate", 0.003)), at, 0.1, **more)
    wheels(family, at, curve, q * gyro_sigma * least / spin)
    if sensors:
        return sensors(family, at, attitude, rates)
    gyro(family, at, rates, gyro_sigma)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


def no_gyro(family, at, attitude, rates):
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


def walking_gyro(family, at, attitude, rates):
    gyro(family, at, rates, 2e-5, walk=3e-6)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


def coarse_gyro(family, at, attitude, rates):
    gyro(family, at, rates, 2e-5, step=1e-4)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


def slow_tracker(family, at, attitude, rates):
    gyro(family, at, rates, 2e-5)
    tracker(family, at[::5], attitude[:, ::5], 5e-5, slow=5e-5, correlation_s=15.0)


def two_directions(family, at, attitude, rates):
    gyro(family, at, rates, 5e-5)
    sun, field = family.draw.direction(), family.draw.direction()
    direction(family, "sun", at[::10], attitude[:, ::10], sun, 2e-3)
    direction(family, "field", at[::10], attitude[:, ::10], field, 5e-3)


def gap_tracker(family, at, attitude, rates):
    gyro(family, at, rates, 2e-5)
    seen = [k for k in range(0, len(at), 5) if (at[k] % 60.0) < 35.0]
    tracker(family, at[seen], attitude[:, seen], 5e-5)


def gravity_gradient(family):
    axis = 6.9e6
    n = np.sqrt(GRAVITY / axis**3)

    def torque(t, turned, whole):
        toward = np.array([np.cos(n * t), np.sin(n * t), 0.0])
        mass = whole[:, 3, 3]
        first = np.stack([whole[:, 2, 4], whole[:, 0, 5], whole[:, 1, 3]], axis=-1) / mass[:, None]
        s = cross_matrix(first)
        about = turned @ (whole[:, :3, :3] + mass[:, None, None] * (s @ s)) @ np.swapaxes(turned, -1, -2)
        return 3 * n * n * np.cross(np.broadcast_to(toward, first.shape), times(about, np.broadcast_to(toward, first.shape)))

    draw = family.draw
    body = bus(draw)
    spin = np.full(len(family.seeds), 0.01)
    all = [(0, a, spin) for a in axes(3, draw)]
    family.bodies([body], {0: '["inertia"]'})
    wheel_texts(family, all)
    curve = Curve(draw, 3, 20.0, (600.0, 2000.0))
    at = grid(6000.0, 0.5)
    still = Still(draw)
    inputs = lambda t: (still.value(t), still.slope(t), curve.value(t))
    attitude, _, rates, _ = fly(Vehicle([body], (), all), inputs, start(draw, 5e-4), at, 1.0, torque=torque)
    wheels(family, at, curve, 0.05)
    gyro(family, at, rates, 5e-5)
    tracker(family, at[::2], attitude[:, ::2], 5e-5)
    family.write(
        lambda k: '[environment]\ngravity = "point_mass"\ngm_m3_s2 = 3.986004418e14\ngravity_gradient = true\n'
        f"orbit = {{ semi_major_axis_m = {axis} }}\n"
    )


def spinner(family, rpm):
    draw = family.draw
    body = bus(draw, 100.0, 400.0)
    body[2][:, 2, 2] = body[2][:, 2, 2] + 0.3 * np.trace(body[2], axis1=1, axis2=2) / 3
    body = (body[0], 0.2 * body[1], body[2])
    family.bodies([body], {0: '["inertia"]'})
    seats = np.array([[0.8, 0, 0.5], [0, 0.8, 0.4], [0.8, 0, 0], [-0.8, 0, 0]]) + 0 * draw.normal(4, 3)
    directions = np.array([[0, 0, -1.0], [0, 1, 0], [0, 1, 0], [0, 1, 0]]) + 0 * seats
    pulses = Pulses(draw, seats, directions, 2.0, 12, (0.3, 1.0), 120.0, 0.01)
    thruster_texts(family, seats, directions)
    rate = 2 * np.pi * rpm / 60
    attitude, place, twist = start(draw, 0.02)
    twist[:, 2] += rate
    at = grid(120.0, 25.0)
    still, none = Still(draw), Still(draw)
    inputs = lambda t: (still.value(t), still.slope(t), none.value(t))
    found = fly(Vehicle([body]), inputs, (attitude, place, twist), at, 0.01 if rpm < 10 else 0.0025, wrench=pulses.wrench)
    fired(family, pulses)
    gyro(family, at, found[2], 2e-4)
    tracker(family, at[::5], found[0][:, ::5], 1e-3)


def gyros_of_moment(family):
    """A pyramid of single-gimbal control moment gyros."""
    draw = family.draw
    body = bus(draw)
    count = len(family.seeds)
    joints, bodies, all = [], [body], []
    for k in range(4):
        angle = k * np.pi / 2 + 0.2
        at = np.array([0.4 * np.cos(angle), 0.4 * np.sin(angle), 0.12]) + np.zeros((count, 3))
        tilt = exponential(np.array([-np.sin(angle), np.cos(angle), 0.0]) * 0.955) + np.zeros((count, 4))
        joints.append((0, at, matrix(tilt), np.array([0, 0, 1.0]) + np.zeros((count, 3))))
        rotor = np.diag([0.06, 0.05, 0.045]) + np.zeros((count, 3, 3))
        bodies.append((np.full(count, 8.0), np.array([0.01, 0, 0.02]) + np.zeros((count, 3)), rotor))
        all.append((k + 1, np.array([1.0, 0, 0]) + np.zeros((count, 3)), np.full(count, 0.05)))
    family.bodies(bodies, {0: '["inertia"]'})
    joint_texts(family, joints)
    wheel_texts(family, all)
    gimbals = Curve(draw, 4, 0.8, (40.0, 120.0))
    speeds = Still(draw, 4, 400.0)
    at = grid(200.0, 10.0)
    inputs = lambda t: (gimbals.value(t), gimbals.slope(t), speeds.value(t))
    attitude, _, rates, _ = fly(Vehicle(bodies, joints, all), inputs, start(draw, 0.002), at, 0.05)
    gyro(family, at, rates, 5e-5)
    tracker(family, at[::5], attitude[:, ::5], 1e-4)
    encoders(family, at, gimbals, 5e-5, 1e-4)
    wheels(family, at, speeds, 0.02)


def dual_spin(family):
    draw = family.draw
    count = len(family.seeds)
    body = bus(draw, 200.0, 500.0)
    drum = np.array([[30, 0.2, 0.1], [0.2, 31, -0.1], [0.1, -0.1, 40]]) + np.zeros((count, 3, 3))
    rotor = (np.full(count, 150.0), np.array([0.002, 0.001, 0.4]) + np.zeros((count, 3)), drum)
    joint = (0, np.array([0.02, 0.01, 0.5]) + np.zeros((count, 3)), np.eye(3) + np.zeros((count, 3, 3)), np.array([0, 0, 1.0]) + np.zeros((count, 3)))
    family.bodies([body, rotor], {0: '["inertia"]'})
    joint_texts(family, [joint])
    turning = Turning(np.full(count, 2 * np.pi))
    none = Still(draw)
    seats = np.array([[0.8, 0, 0.0], [0, 0.8, 0.0], [0, 0, -0.6]]) + 0 * draw.normal(3, 3)
    directions = np.array([[0, 1.0, 0], [0, 0, 1], [1, 0, 0]]) + 0 * seats
    pulses = Pulses(draw, seats, directions, 2.0, 10, (0.5, 2.0), 120.0, 0.01)
    thruster_texts(family, seats, directions)
    at = grid(120.0, 25.0)
    inputs = lambda t: (turning.value(t), turning.slope(t), none.value(t))
    attitude, _, rates, _ = fly(Vehicle([body, rotor], [joint]), inputs, start(draw, 0.005), at, 0.01, wrench=pulses.wrench)
    fired(family, pulses)
    gyro(family, at, rates, 5e-5)
    tracker(family, at[::5], attitude[:, ::5], 1e-4)
    encoders(family, at, turning, 2e-4, 1e-3)


def arm(family, joints, sigma=2e-5, rate_sigma=1e-4, step=0.0, branches=1, carried=False, unknown=None):
    """A bus with arms; the last link, or load, of the first is unknown. `carried`: wheels on the first link turn too."""
    draw = family.draw
    count = len(family.seeds)
    bodies, chain = [bus(draw, 300.0, 600.0)], []
    for branch in range(branches):
        for j in range(joints):
            parent = 0 if j == 0 else len(bodies) - 1
            at = draw.uniform(-0.6, 0.6, 3) if j == 0 else np.array([0.5, 0, 0]) + np.zeros((count, 3))
            chain.append((parent, at, matrix(draw.turn()), draw.direction()))
            mass = draw.uniform(8.0, 20.0)
            link = np.array([0.1 * 0.1, 0.25**2, 0.25**2]) / 3 * mass[:, None]
            about = np.einsum("si,ij->sij", link, np.eye(3))
            bodies.append((mass, np.array([0.25, 0, 0]) + 0.02 * draw.normal(3), about))
    last = joints
    load = draw.uniform(20.0, 80.0)
    bodies[last] = (load, 0.15 * draw.normal(3), load[:, None, None] * tensor(draw, np.full(count, 0.7)))
    family.bodies(bodies, {last: "true"} if unknown is None else unknown)
    joint_texts(family, chain)
    curve = Curve(draw, len(chain), 1.2, (30.0, 90.0))
    all, speeds = [], Still(draw)
    if carried:
        all = [(1, a, np.full(count, 0.05)) for a in axes(3, draw)]
        wheel_texts(family, all)
        speeds = Curve(draw, 3, 100.0, (60.0, 200.0))
    at = grid(150.0, 10.0)
    inputs = lambda t: (curve.value(t), curve.slope(t), speeds.value(t))
    attitude, place, rates, velocity = fly(Vehicle(bodies, chain, all), inputs, start(draw, 0.003, 0.01), at, 0.05)
    if carried:
        wheels(family, at, speeds, 0.02)
    gyro(family, at, rates, 2e-5)
    tracker(family, at[::2], attitude[:, ::2], 5e-5)
    vector(family, "position", "pos", at[::2], place[:, ::2], "m", 1e-3)
    vector(family, "velocity", "vel", at[::2], velocity[:, ::2], "m_s", 2e-4)
    encoders(family, at, curve, sigma, rate_sigma, step)


def thruster_seats(draw):
    """Places and directions of twelve thrusters, two along each axis and sign."""
    seats = 0.3 * draw.uniform(-1, 1, 12, 3)
    directions = np.zeros_like(seats)
    for j in range(12):
        axis, sign = j % 3, 1.0 if j < 6 else -1.0
        directions[:, j, axis] = sign
        seats[:, j, axis] = -sign * 0.9
        seats[:, j, (axis + 1) % 3] += 0.5 * (1 if j % 2 else -1)
    return seats, directions


def all_ten(family, gps, velocity=None, drawn=0.0, common=0.0):
    """Twelve thrusters, all ten numbers of the bus; forces drawn by a share each, or all at once, and declared."""
    draw = family.draw
    body = bus(draw)
    seats, directions = thruster_seats(draw)
    force = 4.0 * (1 + drawn * draw.normal(12)) * (1 + common * draw.normal(1))
    pulses = Pulses(draw, seats, directions, force, 30, (1.0, 4.0), 300.0, 0.1)
    family.bodies([body], {0: "true"})
    extra = ""
    if drawn or common:
        share = np.hypot(drawn, common)
        extra = f"uncertainty = {{ force = {share:.6g} }}\n"
    if common:
        correlation = common**2 / (common**2 + drawn**2)
        family.model = [m.replace("exact = true\n", f"exact = true\nthrust_correlation = {correlation:.6g}\n") for m in family.model]
    thruster_texts(family, seats, directions, extra)
    at = grid(300.0, 10.0)
    still, none = Still(draw), Still(draw)
    inputs = lambda t: (still.value(t), still.slope(t), none.value(t))
    attitude, place, rates, speed = fly(Vehicle([body]), inputs, start(draw, 0.003, 0.005), at, 0.02, wrench=pulses.wrench)
    declared = Pulses.__new__(Pulses)
    declared.__dict__.update(pulses.__dict__, force=4.0)
    fired(family, declared)
    gyro(family, at, rates, 2e-5)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)
    vector(family, "position", "pos", at[::10], place[:, ::10], "m", gps)
    if velocity:
        vector(family, "velocity", "vel", at[::10], speed[:, ::10], "m_s", velocity)


def panels(family, unknown=False):
    """A bus with two panels on hinges, and three wheels that slew it."""
    draw = family.draw
    count = len(family.seeds)
    body = bus(draw, 150.0, 500.0)
    bodies, chain, about = [body], [], []
    for side in (1.0, -1.0):
        mass = 0.02 * body[0] * draw.uniform(0.7, 1.3)
        length = draw.uniform(1.5, 3.0)
        own = mass[:, None] * np.stack([length**2, np.full(count, 1.0), length**2 + 1.0], axis=-1) / 12
        bodies.append((mass, np.stack([0 * mass, side * length / 2, 0 * mass], axis=-1), np.einsum("si,ij->sij", own, np.eye(3))))
        about.append(own[:, 0] + mass * length**2 / 4)
        seat = matrix(exponential(np.array([0.0, 1.0, 0.0]) * draw.uniform(-0.5, 0.5)[:, None]))
        chain.append((0, np.array([0, side * 0.7, 0]) + 0.1 * draw.normal(3), seat, np.array([1.0, 0, 0]) + np.zeros((count, 3))))
    springs = (*held(np.stack(about, axis=-1), draw, 0.08, 0.4, 0.005), 0.1 * draw.normal(2))
    least = np.linalg.eigvalsh(body[2])[:, 0]
    all = [(0, a, least * draw.uniform(3e-4, 8e-4)) for a in axes(3, draw)]
    # Fast enough to move the panels.
    curve = Curve(draw, 3, 100.0, (10.0, 60.0))
    family.bodies(bodies, {0: '["inertia"]'})
    sprung(family, chain, springs, unknown)
    wheel_texts(family, all)
    at = grid(200.0, 10.0)
    joints = (springs[2], np.zeros((count, 2)))
    swinging = Swinging(Vehicle(bodies, chain, all), springs)
    attitude, place, rates, velocity = swing(swinging, curve, start(draw, 0.003), joints, at, 0.05)
    wheels(family, at, curve, 0.01)
    gyro(family, at, rates, 2e-5)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


def whole(bodies, joints, q):
    """Mass, mass centre and inertia of a tree at rest with its joints there, in the frame of the base."""
    turned, origin, _ = Swinging(Vehicle(bodies, joints), None).place(q)
    at = [o for o in origin]
    for k, (parent, *_) in enumerate(joints):
        at[k + 1] = at[parent] + origin[k + 1]
    places = [o + times(t, c) for (_, c, _), t, o in zip(bodies, turned, at)]
    mass = sum(m for m, *_ in bodies)
    centre = sum(m[:, None] * p for (m, *_), p in zip(bodies, places)) / mass[:, None]
    about = 0.0
    for (m, _, own), t, p in zip(bodies, turned, places):
        arm = cross_matrix(p - centre)
        about = about + t @ own @ np.swapaxes(t, -1, -2) - m[:, None, None] * arm @ arm
    return mass, centre, about


def hidden(family, count_of, share, low_Hz, high_Hz, ratio, gyro_sigma=2e-5, rate_hz=10.0):
    """A bus with appendages on springs that the model does not have: it is one rigid body."""
    draw = family.draw
    count = len(family.seeds)
    body = bus(draw, 100.0, 600.0)
    bodies, chain, about = [body], [], []
    for _ in range(count_of):
        mass = share / count_of * body[0] * draw.uniform(0.6, 1.6)
        length = draw.uniform(0.4, 2.5)
        own = mass[:, None] * np.stack([length**2, np.full(count, 0.3), length**2 + 0.3], axis=-1) / 12
        bodies.append((mass, np.stack([0 * mass, length / 2, 0 * mass], axis=-1), np.einsum("si,ij->sij", own, np.eye(3))))
        about.append(own[:, 0] + mass * length**2 / 4)
        seat = matrix(draw.turn())
        chain.append((0, 0.6 * draw.direction(), seat, np.array([1.0, 0, 0]) + np.zeros((count, 3))))
    springs = (*held(np.stack(about, axis=-1), draw, low_Hz, high_Hz, ratio), np.zeros((count, count_of)))
    still = whole(bodies, chain, springs[2])
    least = np.linalg.eigvalsh(still[2])[:, 0]
    all = [(0, a, least * draw.uniform(3e-4, 8e-4)) for a in axes(3, draw)]
    curve = Curve(draw, 3, 100.0, (8.0, 80.0))
    family.bodies([still], {0: '["inertia"]'})
    wheel_texts(family, all)
    at = grid(240.0, rate_hz)
    joints = (springs[2], np.zeros((count, count_of)))
    swinging = Swinging(Vehicle(bodies, chain, all), springs)
    step = 0.5 / rate_hz
    attitude, place, rates, velocity = swing(swinging, curve, start(draw, 0.003), joints, at, step)
    wheels(family, at, curve, 0.01)
    gyro(family, at, rates, gyro_sigma)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


def pendulum(family, rate=0.003, force=4.0, unknown="true"):
    """A bus with propellant as a pendulum of two hinges, or of one without a spring where it spins, under thrust."""
    draw = family.draw
    count = len(family.seeds)
    spins = rate > 0.1
    body = bus(draw, 200.0, 500.0)
    if spins:
        body[2][:, 2, 2] = body[2][:, 2, 2] + 0.5 * np.trace(body[2], axis1=1, axis2=2) / 3
    mass = 0.05 * body[0] * draw.uniform(0.7, 1.3)
    arm = draw.uniform(0.2, 0.5)
    tiny = np.einsum("s,ij->sij", 0.01 * mass, np.eye(3))
    bob = (mass, np.stack([arm, 0 * arm, 0 * arm], axis=-1), tiny)
    at_hinge = np.array([0.3, 0, 0]) + 0.1 * draw.normal(3)
    x, y, z = np.eye(3)
    level = np.broadcast_to(np.eye(3), (count, 3, 3))
    if spins:
        # The spin holds it outward.
        bodies, chain = [body, bob], [(0, at_hinge, level, z + np.zeros((count, 3)))]
        about = 0 * np.stack([mass], axis=-1)
    else:
        knee = (0.05 * mass, np.zeros((count, 3)), 0.02 * tiny)
        bodies = [body, knee, bob]
        chain = [(0, at_hinge, level, y + np.zeros((count, 3))), (1, np.zeros((count, 3)), level, z + np.zeros((count, 3)))]
        about = np.stack([mass * arm**2] * 2, axis=-1)
    springs = (*held(about, draw, 0.03, 0.15, 0.02), np.zeros_like(about))
    if spins:
        springs = (springs[0], np.stack([0.002 * mass * arm**2], axis=-1), springs[2])
    seats, directions = thruster_seats(draw)
    pulses = Pulses(draw, seats, directions, np.full((count, 12), force), 30, (1.0, 4.0), 200.0, 0.1)
    family.bodies(bodies, {0: unknown})
    sprung(family, chain, springs)
    thruster_texts(family, seats, directions)
    attitude, place, twist = start(draw, 0.003, 0.005)
    twist[:, 2] += rate
    at = grid(200.0, 10.0)
    joints = (0.3 * draw.normal(len(chain)), np.zeros((count, len(chain))))
    swinging = Swinging(Vehicle(bodies, chain), springs)
    found = swing(swinging, Still(draw), (attitude, place, twist), joints, at, 0.02, wrench=pulses.wrench)
    attitude, place, rates, speed = found
    fired(family, pulses)
    gyro(family, at, rates, 2e-5)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)
    if unknown == "true":
        vector(family, "position", "pos", at[::10], place[:, ::10], "m", 0.1)
        vector(family, "velocity", "vel", at[::10], speed[:, ::10], "m_s", 2e-3)


FAMILIES = {
    "wheels_q0.3": lambda f: with_wheels(f),
    "wheels_q1": lambda f: with_wheels(f, q=1.0),
    "wheels_q5": lambda f: with_wheels(f, q=5.0),
    "wheels_q20": lambda f: with_wheels(f, q=20.0),
    "pyramid_biased": lambda f: with_wheels(f, wheels=4, base=150.0),
    "no_gyro": lambda f: with_wheels(f, sensors=no_gyro),
    "gyro_walk": lambda f: with_wheels(f, sensors=walking_gyro),
    "gyro_coarse": lambda f: with_wheels(f, sensors=coarse_gyro),
    "tracker_slow": lambda f: with_wheels(f, sensors=slow_tracker),
    "tracker_gaps": lambda f: with_wheels(f, sensors=gap_tracker),
    "sun_field": lambda f: with_wheels(f, sensors=two_directions),
    "gravity_gradient": gravity_gradient,
    "spinner_5rpm": lambda f: spinner(f, 5.0),
    "spinner_20rpm": lambda f: spinner(f, 20.0),
    "spinner_60rpm": lambda f: spinner(f, 60.0),
    "cmg_pyramid": gyros_of_moment,
    "dual_spin": dual_spin,
    "arm3": lambda f: arm(f, 3),
    "arm6": lambda f: arm(f, 6, sigma=1e-5),
    "arm7": lambda f: arm(f, 7, sigma=1e-4, rate_sigma=1e-3),
    "arm3_3mrad": lambda f: arm(f, 3, sigma=3e-3, rate_sigma=1e-3),
    "arm3_step": lambda f: arm(f, 3, rate_sigma=None, step=np.radians(0.1)),
    "arm3_no_rates": lambda f: arm(f, 3, sigma=1e-5, rate_sigma=None),
    "arm3_coarse": lambda f: arm(f, 3, sigma=5e-4, rate_sigma=None),
    "arms_two": lambda f: arm(f, 3, branches=2),
    "wheels_on_link": lambda f: arm(f, 2, carried=True, unknown={2: '["inertia"]'}),
    "thrusters_gps0.1": lambda f: all_ten(f, 0.1, 2e-3),
    "thrusters_gps2": lambda f: all_ten(f, 2.0),
    "thrusters_drawn": lambda f: all_ten(f, 0.1, 2e-3, drawn=0.05),
    "thrusters_common": lambda f: all_ten(f, 0.1, 2e-3, drawn=0.02, common=0.05),
    "panels": panels,
    "panels_unknown": lambda f: panels(f, unknown=True),
    "hidden_one": lambda f: hidden(f, 1, 0.03, 0.06, 0.6, 0.005),
    "hidden_two": lambda f: hidden(f, 2, 0.05, 0.06, 1.0, 0.005),
    "hidden_light": lambda f: hidden(f, 1, 0.004, 0.1, 1.5, 0.003, gyro_sigma=1e-5),
    "hidden_damped": lambda f: hidden(f, 2, 0.04, 0.05, 0.4, 0.03),
    "pendulum_thrust": pendulum,
    "pendulum_spinner": lambda f: pendulum(f, rate=2 * np.pi * 3.0 / 60, unknown='["inertia"]'),
}


def quiet(family, rate=0.0, speed=0.0, gyro_sigma=2e-5, step=0.0, step_s=0.1):
    """One body that turns freely, at a rate and its wheels at a speed, rad/s: there is nothing to find but what it tells."""
    draw = family.draw
    body = bus(draw)
    family.bodies([body], {0: '["inertia"]'})
    turn = draw.direction() * draw.uniform(0.8, 1.2)[:, None]
    attitude, place, twist = start(draw, 0.0)
    twist[:, :3] += rate * turn
    all = []
    if speed:
        spin = np.linalg.eigvalsh(body[2])[:, 0] * draw.uniform(3e-4, 8e-4)
        all = [(0, a, spin) for a in axes(3, draw)]
        wheel_texts(family, all)
    curve = Curve(draw, 3, 0.0, (60.0, 200.0), base=speed)
    still, at = Still(draw), grid(120.0, 10.0)
    inputs = lambda t: (still.value(t), still.slope(t), curve.value(t) if all else still.value(t))
    attitude, _, rates, _ = fly(Vehicle([body], (), all), inputs, (attitude, place, twist), at, step_s)
    if all:
        wheels(family, at, curve, 0.05)
    gyro(family, at, rates, gyro_sigma, step=step)
    tracker(family, at[::5], attitude[:, ::5], 5e-5)


# Records that tell little, with nothing wrong.
QUIET = {
    "rest": lambda f: quiet(f),
    "rest_coarse": lambda f: quiet(f, step=1e-3),
    "rest_wheels": lambda f: quiet(f, speed=100.0),
    "slow_spin": lambda f: quiet(f, rate=np.radians(0.01)),
    "slow_coarse": lambda f: quiet(f, rate=np.radians(0.01), step=1e-3),
    "slow_wheels": lambda f: quiet(f, rate=np.radians(0.01), speed=100.0),
    "fast_spin": lambda f: quiet(f, rate=10.0, gyro_sigma=2e-4, step_s=0.0025),
    "fast_coarse": lambda f: quiet(f, rate=10.0, gyro_sigma=2e-4, step=1e-2, step_s=0.0025),
}


def write_family(name, seeds, out):
    family = Family(name, seeds)
    (FAMILIES | QUIET)[name](family)
    folders = []
    for k, seed in enumerate(seeds):
        folder = out / f"{name}_{seed}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.toml").write_text(family.model[k])
        for file, times_s, names, values in family.tables[k]:
            rows = np.column_stack([times_s, values])
            np.savetxt(folder / f"{file}.csv", rows, fmt="%.12g", delimiter=",", header=",".join(["time_s", *names]), comments="")
        truth = {}
        for b in family.unknown:
            mass, centre, about = (x[k] for x in family.truth[b])
            truth[f"b{b}"] = {"mass": mass, "com": list(centre), "inertia": {e: about[i, j] for e, (i, j) in ELEMENTS.items()}}
        (folder / "truth.json").write_text(json.dumps(truth))
        folders.append(folder)
    return folders


def identify(program, version, folder):
    """The exit code; a record that the same program has identified before is not identified again."""
    mark = folder / "done.json"
    if mark.exists():
        done = json.loads(mark.read_text())
        if done["program"] == version:
            return folder, done["code"]
    files = ",".join(sorted(p.name for p in folder.glob("*.csv")))
    run = [program, "identify", "--model", "model.toml", "--telemetry", files, "--out", "out"]
    try:
        done = subprocess.run(run, cwd=folder, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired:
        return folder, -1
    (folder / "said.txt").write_text(done.stdout + done.stderr)
    mark.write_text(json.dumps({"program": version, "code": done.returncode}))
    return folder, done.returncode


class Score:
    """How far an answer is off: (estimate - truth) / sigma of every number that is given, and the square of all together."""

    def __init__(self, folder):
        truth = json.loads((folder / "truth.json").read_text())
        answer = json.loads((folder / "out/estimate.json").read_text())
        self.z, off = {}, {}
        for body, numbers in truth.items():
            given = answer["bodies"][body]
            all = [("mass_kg", given.get("mass_kg"), numbers["mass"])]
            all += [(f"com_m.{a}", (given.get("com_m") or {}).get(a), numbers["com"][i]) for i, a in enumerate("xyz")]
            tensor = given.get("inertia_kg_m2") or {}
            all += [(f"inertia_kg_m2.{e}", tensor.get(e), x) for e, x in numbers["inertia"].items()]
            for name, number, true in all:
                if number and number.get("value") is not None and number.get("sigma"):
                    off[f"{body}.{name}"] = number["value"] - true
                    self.z[f"{body}.{name}"] = off[f"{body}.{name}"] / number["sigma"]
        names = [n for n in answer["covariance"]["names"] if n in off]
        at = [answer["covariance"]["names"].index(n) for n in names]
        covariance = np.array(answer["covariance"]["matrix"])[np.ix_(at, at)]
        unit = np.sqrt(np.diag(covariance))
        squares, axes = np.linalg.eigh(covariance / np.outer(unit, unit))
        along = axes.T @ (np.array([off[n] for n in names]) / unit)
        # Numbers that depend on each other are counted once.
        free = squares > 1e-9
        self.square, self.numbers = np.sum(along[free] ** 2 / squares[free]), int(np.sum(free))


def finding(folder, code):
    """What is said against a record that has nothing wrong."""
    if code not in (0, 1):
        return f"exit code {code}"
    status = json.loads((folder / "out/estimate.json").read_text())["status"]
    if status in ("rejected", "iteration_limit"):
        return status
    largest = max(map(abs, Score(folder).z.values()), default=0.0) if code == 0 else 0.0
    return f"{largest:.1f} sigma off" if largest > 5.0 else None


def two_sided(square, numbers):
    """Chance of a chi-square as far from its mean, by the cube root's normal distribution (Wilson and Hilferty 1931)."""
    spread = 2.0 / (9.0 * numbers)
    z = ((square / numbers) ** (1 / 3) - (1.0 - spread)) / math.sqrt(spread)
    return math.erfc(abs(z) / math.sqrt(2.0))


def so_few(answered, records, share):
    """Chance of as few answers where each record has one with this chance."""
    term = lambda k: math.comb(records, k) * share**k * (1.0 - share) ** (records - k)
    return sum(term(k) for k in range(answered + 1))


class Line:
    """The records of a family, or of all."""

    def __init__(self, name, records):
        self.name, self.records = name, len(records)
        answered = [(folder, score) for folder, code, score in records if code == 0]
        self.answered = len(answered)
        self.z = np.array([x for _, score in answered for x in score.z.values()])
        self.square = sum(score.square for _, score in answered)
        self.numbers = sum(score.numbers for _, score in answered)
        self.p = two_sided(self.square, self.numbers) if self.numbers else 1.0
        largest = lambda r: max(map(abs, r[1].z.values()), default=0.0)
        self.worst = max(answered, key=largest)[0].name if answered else ""

    def text(self):
        found = f"{self.name:18s} {self.answered:4d} of {self.records:4d}"
        if not len(self.z):
            return found
        within = 100 * np.mean(abs(self.z) < 1.96)
        found += f"  mean {self.z.mean():+5.2f}  rms {np.sqrt(np.mean(self.z**2)):5.2f}  within {within:5.1f} %"
        return found + f"  NEES {self.square / self.numbers:5.2f} (p {self.p:7.1e})  largest {abs(self.z).max():5.2f} ({self.worst})"


def faults(lines, pooled):
    """What a calibrated estimator would hardly do: family-wise 0.1 %, the smallest p first (Holm 1979)."""
    ordered = sorted([*lines, pooled], key=lambda l: l.p)
    for k, l in enumerate(ordered):
        if l.p >= 1e-3 / (len(ordered) - k):
            break
        yield f"{l.name}: NEES {l.square / l.numbers:.2f} of {l.numbers} numbers, p {l.p:.1e}"
    for l, share in [(l, 0.85) for l in lines] + [(pooled, 0.97)]:
        if so_few(l.answered, l.records, share) < 1e-3:
            yield f"{l.name}: {l.answered} of {l.records} answered, {100 * share:.0f} % wanted"
    if len(pooled.z) and abs(pooled.z).max() > 5.0:
        yield f"{pooled.worst}: a number is {abs(pooled.z).max():.1f} sigma off"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", default="")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target/families")
    parser.add_argument("--poinsot", default=str(ROOT / "target/release/poinsot"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--quiet", action="store_true")
    given = parser.parse_args()
    everything, lines = [], []
    seeds = range(given.first, given.first + given.seeds)
    version = hashlib.sha256(pathlib.Path(given.poinsot).read_bytes()).hexdigest()
    for name in (n for n in (QUIET if given.quiet else FAMILIES) if given.only in n):
        folders = write_family(name, seeds, given.out)
        with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
            done = list(pool.map(lambda f: identify(given.poinsot, version, f), folders))
        if given.quiet:
            found = [(folder.name, finding(folder, code)) for folder, code in done]
            everything += [one for one in found if one[1]]
            print(f"{name:18s} {len(found):4d} records", *(": ".join(one) for one in found if one[1]), sep="\n    ", flush=True)
            continue
        records = [(folder, code, Score(folder) if code == 0 else None) for folder, code in done]
        lines.append(Line(name, records))
        print(lines[-1].text(), flush=True)
        for folder, code, _ in records:
            if code != 0:
                print(f"    {folder.name}: exit code {code}", flush=True)
        everything += records
    if given.quiet:
        print(f"{len(everything)} with a finding")
        sys.exit(1 if everything else 0)
    pooled = Line("all", everything)
    print(pooled.text())
    found = list(faults(lines, pooled)) if given.check else []
    for fault in found:
        print(f"not calibrated: {fault}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
