"""Free motion of a tree of rigid bodies whose joints and wheels move as told, for many vehicles at once.

Momentum about the origin of the inertial frame is the state beside the pose of the base. NumPy alone: nothing here is shared with
what is judged. Arrays have the vehicles as their first axis. Frames: N inertial, B the base; vectors of bodies are in B."""

import numpy as np


def cross_matrix(v):
    out = np.zeros(v.shape[:-1] + (3, 3))
    out[..., 0, 1], out[..., 0, 2], out[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    out[..., 1, 0], out[..., 2, 0], out[..., 2, 1] = v[..., 2], -v[..., 1], v[..., 0]
    return out


def times(m, v):
    return np.einsum("...ij,...j->...i", m, v)


def product(a, b):
    """Hamilton product of quaternions (x, y, z, w)."""
    v = a[..., 3:] * b[..., :3] + b[..., 3:] * a[..., :3] + np.cross(a[..., :3], b[..., :3])
    w = a[..., 3] * b[..., 3] - np.sum(a[..., :3] * b[..., :3], axis=-1)
    return np.concatenate([v, w[..., None]], axis=-1)


def exponential(phi):
    """Quaternion of a rotation vector."""
    half = 0.5 * np.linalg.norm(phi, axis=-1, keepdims=True)
    return np.concatenate([0.5 * phi * np.sinc(half / np.pi), np.cos(half)], axis=-1)


def matrix(q):
    x, y, z, w = np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def rotation(axis, angle):
    return matrix(exponential(axis * angle[..., None]))


class Vehicle:
    """`bodies`: mass [S], mass centre [S, 3], tensor about it [S, 3, 3]. `joints`: parent, origin [S, 3], rotation [S, 3, 3],
    axis [S, 3], one for each body but the first. `wheels`: body, axis [S, 3], spin inertia [S]."""

    def __init__(self, bodies, joints=(), wheels=()):
        self.bodies, self.joints, self.wheels = list(bodies), list(joints), list(wheels)

    def momentum_map(self, q, qd, speeds):
        """Mass matrix of the base's twist (angular, linear) about its origin, and the momentum at rest of the base."""
        count = len(self.bodies[0][0])
        turned = [np.broadcast_to(np.eye(3), (count, 3, 3))]
        origin, rate, velocity = [np.zeros((count, 3))], [np.zeros((count, 3))], [np.zeros((count, 3))]
        for k, (parent, at, seat, axis) in enumerate(self.joints):
            place = times(turned[parent], at)
            seated = turned[parent] @ seat
            turned.append(seated @ rotation(axis, q[:, k]))
            origin.append(origin[parent] + place)
            velocity.append(velocity[parent] + np.cross(rate[parent], place))
            rate.append(rate[parent] + times(seated, axis) * qd[:, k, None])
        mass, first, tensor = np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3, 3))
        linear, angular = np.zeros((count, 3)), np.zeros((count, 3))
        for b, (m, c, about) in enumerate(self.bodies):
            arm = times(turned[b], c)
            r = origin[b] + arm
            own = turned[b] @ about @ np.swapaxes(turned[b], -1, -2)
            v = velocity[b] + np.cross(rate[b], arm)
            s = cross_matrix(r)
            mass = mass + m
            first = first + m[:, None] * r
            tensor = tensor + own - m[:, None, None] * (s @ s)
            linear = linear + m[:, None] * v
            angular = angular + times(own, rate[b]) + np.cross(r, m[:, None] * v)
        for w, (body, axis, spin) in enumerate(self.wheels):
            angular = angular + times(turned[body], axis) * (spin * speeds[:, w])[:, None]
        whole = np.zeros((count, 6, 6))
        whole[:, :3, :3], whole[:, :3, 3:] = tensor, cross_matrix(first)
        whole[:, 3:, :3] = -cross_matrix(first)
        whole[:, 3:, 3:] = mass[:, None, None] * np.eye(3)
        return whole, np.concatenate([angular, linear], axis=-1)


def followed(slope, state, times_s, step_s):
    """The state at each time by the classical Runge-Kutta rule; the attitude is the first of it."""
    t = 0.0
    for end in times_s:
        while t < end - 1e-9:
            h = min(step_s, end - t)
            within = t + h / 2
            k1 = slope(t, within, *state)
            k2 = slope(t + h / 2, within, *(x + h / 2 * k for x, k in zip(state, k1)))
            k3 = slope(t + h / 2, within, *(x + h / 2 * k for x, k in zip(state, k2)))
            k4 = slope(t + h, within, *(x + h * k for x, k in zip(state, k3)))
            state = tuple(x + h / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(state, k1, k2, k3, k4))
            state = (state[0] / np.linalg.norm(state[0], axis=-1, keepdims=True),) + state[1:]
            t = t + h
        yield end, state


def fly(vehicle, inputs, start, times_s, step_s, wrench=None, torque=None):
    """Pose, twist at the given times. `inputs(t)` gives q, qd, wheel speeds; `start` is quaternion, position, twist of the base;
    `wrench(t)` torque about the base's origin and force, in B, constant over a step; `torque(t, q_NB, whole)` about the mass centre, in N."""
    attitude, place, twist = start

    def state_of(t, q, p, momentum):
        whole, moving = vehicle.momentum_map(*inputs(t))
        turned = matrix(q)
        linear = momentum[:, 3:]
        angular = momentum[:, :3] - np.cross(p, linear)
        back = np.swapaxes(turned, -1, -2)
        inside = np.concatenate([times(back, angular), times(back, linear)], axis=-1)
        return turned, whole, np.linalg.solve(whole, (inside - moving)[..., None])[..., 0]

    def slope(t, within, q, p, momentum):
        turned, whole, v = state_of(t, q, p, momentum)
        push = np.zeros_like(momentum)
        if wrench is not None:
            about, force = wrench(within)
            force = times(turned, force)
            push = np.concatenate([times(turned, about) + np.cross(p, force), force], axis=-1)
        if torque is not None:
            push[:, :3] += torque(t, turned, whole)
        spin = np.concatenate([0.5 * v[:, :3], np.zeros((len(v), 1))], axis=-1)
        return product(q, spin), times(turned, v[:, 3:]), push

    whole, moving = vehicle.momentum_map(*inputs(0.0))
    inside = times(whole, twist) + moving
    turned = matrix(attitude)
    linear = times(turned, inside[:, 3:])
    momentum = np.concatenate([times(turned, inside[:, :3]) + np.cross(place, linear), linear], axis=-1)
    out = []
    for end, now in followed(slope, (attitude, place, momentum), times_s, step_s):
        turned, _, v = state_of(end, *now)
        out.append((now[0], now[1], v[:, :3], times(turned, v[:, 3:])))
    return [np.stack(x, axis=1) for x in zip(*out)]


class Swinging:
    """A tree whose joints springs alone move, by Newton and Euler: accelerations of all bodies, and what holds them. `springs`:
    stiffness, damping, rest [S, joints]."""

    def __init__(self, vehicle, springs):
        self.vehicle, self.springs = vehicle, springs

    def place(self, q):
        turned, origin, axes = [np.broadcast_to(np.eye(3), (len(q), 3, 3))], [np.zeros((len(q), 3))], [None]
        for k, (parent, at, seat, axis) in enumerate(self.vehicle.joints):
            seated = turned[parent] @ seat
            turned.append(seated @ rotation(axis, q[:, k]))
            origin.append(times(turned[parent], at))
            axes.append(times(seated, axis))
        return turned, origin, axes

    def held(self, placed, w, qd, speeds, turn, fall, qdd, torques):
        """Torque about the base's origin, force, and torque of each joint at these accelerations."""
        turned, arms, axes = placed
        rate, alpha, a = [w], [turn], [fall]
        for k, (parent, *_) in enumerate(self.vehicle.joints):
            r, s = arms[k + 1], axes[k + 1]
            a.append(a[parent] + np.cross(alpha[parent], r) + np.cross(rate[parent], np.cross(rate[parent], r)))
            alpha.append(alpha[parent] + s * qdd[:, k, None] + np.cross(rate[parent], s) * qd[:, k, None])
            rate.append(rate[parent] + s * qd[:, k, None])
        force, torque = [], []
        for b, (m, c, about) in enumerate(self.vehicle.bodies):
            arm = times(turned[b], c)
            own = turned[b] @ about @ np.swapaxes(turned[b], -1, -2)
            force.append(m[:, None] * (a[b] + np.cross(alpha[b], arm) + np.cross(rate[b], np.cross(rate[b], arm))))
            torque.append(times(own, alpha[b]) + np.cross(rate[b], times(own, rate[b])) + np.cross(arm, force[b]))
        for j, (body, axis, spin) in enumerate(self.vehicle.wheels):
            along = times(turned[body], axis)
            torque[body] = torque[body] + along * (spin * torques[:, j])[:, None]
            torque[body] = torque[body] + np.cross(rate[body], along * (spin * speeds[:, j])[:, None])
        joints = np.zeros_like(qd)
        for k in reversed(range(len(self.vehicle.joints))):
            parent = self.vehicle.joints[k][0]
            joints[:, k] = np.sum(axes[k + 1] * torque[k + 1], axis=-1)
            torque[parent] = torque[parent] + torque[k + 1] + np.cross(arms[k + 1], force[k + 1])
            force[parent] = force[parent] + force[k + 1]
        return np.concatenate([torque[0], force[0], joints], axis=-1)

    def accelerations(self, w, q, qd, speeds, torques, wrench):
        placed, still = self.place(q), np.zeros_like(q)
        none, size = np.zeros_like(w), 6 + q.shape[1]
        moving = self.held(placed, w, qd, speeds, none, none, still, torques)
        columns = []
        for k in range(size):
            unit = np.zeros((len(q), size))
            unit[:, k] = 1.0
            columns.append(self.held(placed, none, still, 0 * speeds, unit[:, :3], unit[:, 3:6], unit[:, 6:], 0 * torques))
        stiffness, damping, rest = self.springs
        push = np.concatenate([*wrench, -stiffness * (q - rest) - damping * qd], axis=-1)
        return np.linalg.solve(np.stack(columns, axis=-1), (push - moving)[..., None])[..., 0]


def swing(swinging, curve, start, joints, times_s, step_s, wrench=None):
    """Pose and twist of the base at the given times; `curve` has wheel speeds, `joints` positions and rates at the start."""
    attitude, place, twist = start
    none = np.zeros_like(place)

    def slope(t, within, q_NB, p, v, w, q, qd):
        turned = matrix(q_NB)
        push = (none, none) if wrench is None else wrench(within)
        found = swinging.accelerations(w, q, qd, curve.value(t), curve.slope(t), push)
        spin = np.concatenate([0.5 * w, np.zeros((len(w), 1))], axis=-1)
        return product(q_NB, spin), v, times(turned, found[:, 3:6]), found[:, :3], qd, found[:, 6:]

    state = (attitude, place, times(matrix(attitude), twist[:, 3:]), twist[:, :3], *joints)
    out = [(q, p, w, v) for _, (q, p, v, w, *_) in followed(slope, state, times_s, step_s)]
    return [np.stack(x, axis=1) for x in zip(*out)]
