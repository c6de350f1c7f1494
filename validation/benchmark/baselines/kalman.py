"""A plain extended Kalman filter with the unknown numbers as constant states, for all seeds of a vehicle at once.

State: attitude, place of the base's origin, momentum (angular about the mass centre, linear) in N, gyro bias, numbers. Rates follow from
momentum and the measured joints and wheels, whose noise adds to that of gyro and motion. The numbers start at nominal with the prior
of numbers.csv. Slopes are forward differences. A number whose sigma stays above half of its prior is refused."""

import numpy as np

from common import SENSORS, Record, motion

STATES = 15
UNITS = {"gyro": "rad_s", "attitude": "rad", "position": "m", "velocity": "m_s"}


def centre_of(whole):
    """Of the vehicle from the base's origin, from its mass matrix."""
    return np.stack([whole[:, 2, 4], whole[:, 0, 5], whole[:, 1, 3]], axis=-1) / whole[:, 3, 3][:, None]


def back(q, v):
    return motion.times(np.swapaxes(motion.matrix(q), -1, -2), v)


class Filter:
    """`q` [S, 4] and `x` [S, 15 + n]: turn (kept at zero), place, momentum, bias, numbers; `covariance` [S, 15 + n, 15 + n]."""

    def __init__(self, records):
        self.records, one = records, records[0]
        self.translating = one.tables["vel"] is not None
        self.times_s = one.times_s
        parts = [r.inputs() for r in records]
        self.given = np.stack([np.concatenate(p[:3], axis=1) for p in parts])
        self.sizes = np.cumsum([p.shape[1] for p in parts[0][:3]])
        self.input_variance = parts[0][3]
        n = len(one.names)
        self.step = np.concatenate([np.full(3, 1e-6), np.full(3, 1e-4), np.full(6, 1e-4), np.full(3, 1e-7), 1e-3 * one.prior])
        self.q = np.stack([r.tables["st"][0, 1:] for r in records])
        self.x = np.zeros((len(records), STATES + n))
        self.x[:, STATES:] = [r.nominal for r in records]
        self.begin(one)

    def begin(self, one):
        """First pose and momentum from the first samples."""
        first = lambda file: np.stack([r.tables[file][0, 1:] if r.tables[file] is not None else np.zeros(3) for r in self.records])
        rates, velocity = first("gyro"), first("vel")
        self.x[:, 3:6] = first("pos")
        whole, moving = self.masses(self.x[:, STATES:], self.given[:, 0])
        inside = motion.times(whole, np.concatenate([rates, back(self.q, velocity)], axis=1)) + moving
        turned = motion.matrix(self.q)
        linear = motion.times(turned, inside[:, 3:]) if self.translating else np.zeros_like(rates)
        self.x[:, 6:9] = motion.times(turned, inside[:, :3] - np.cross(centre_of(whole), inside[:, 3:]))
        self.x[:, 9:12] = linear
        size = np.array([np.trace(w[:3, :3]) for w in whole])
        sigma = np.zeros(self.x.shape)
        sigma[:, :3] = one.variance("attitude", "rad") ** 0.5
        sigma[:, 6:9] = (0.02 * size + 0.2 * np.linalg.norm(self.x[:, 6:9], axis=1))[:, None]
        if self.translating:
            sigma[:, 3:6] = one.variance("position", "m") ** 0.5
            sigma[:, 9:12] = (0.05 * whole[:, 3, 3] + 0.2 * np.linalg.norm(linear, axis=1))[:, None]
        sigma[:, 12:15] = 1e-3
        sigma[:, STATES:] = one.prior
        self.covariance = np.einsum("si,ij->sij", sigma**2, np.eye(sigma.shape[1]))

    def masses(self, numbers, given):
        """Mass matrix and momentum of joints and wheels; rows of numbers and inputs belong together."""
        one, count = self.records[0], len(numbers)
        spread = lambda parts: [tuple(p if isinstance(p, int) else np.repeat(p, count, axis=0) for p in part) for part in parts]
        vehicle = motion.Vehicle(one.body_values(numbers), spread(one.joints), spread(one.wheels))
        a, b, _ = self.sizes
        return vehicle.momentum_map(given[:, :a], given[:, a:b], given[:, b:])

    def velocities(self, q, x, given):
        """Rates in B, velocity of the base's origin in N (of rest of the mass centre where nothing translates), mass centre in B."""
        whole, moving = self.masses(x[:, STATES:], given)
        centre = centre_of(whole)
        linear = back(q, x[:, 9:12])
        inside = np.concatenate([back(q, x[:, 6:9]) + np.cross(centre, linear), linear], axis=1)
        twist = np.linalg.solve(whole, (inside - moving)[..., None])[..., 0]
        return twist[:, :3], motion.times(motion.matrix(q), twist[:, 3:]), centre

    def ahead(self, q, x, now, then, wrench, h):
        """State after h, inputs linear in between, wrench constant in B."""
        x, begin = x.copy(), self.velocities(q, x, now)
        about, force = np.broadcast_to(wrench[:3], x[:, :3].shape), np.broadcast_to(wrench[3:], x[:, :3].shape)
        about = about - np.cross(begin[2], force)

        def pushed(turn):
            y, turned = x.copy(), motion.matrix(motion.product(q, motion.exponential(turn / 2)))
            y[:, 6:9] += h * motion.times(turned, about)
            y[:, 9:12] += h * motion.times(turned, force) * self.translating
            return y

        guess = pushed(h * begin[0])
        end = self.velocities(motion.product(q, motion.exponential(h * begin[0])), guess, then)
        turn = h / 2 * (begin[0] + end[0]) + h * h / 12 * np.cross(begin[0], end[0])
        y = pushed(turn)
        y[:, 3:6] += h / 2 * (begin[1] + end[1]) * self.translating
        return motion.product(q, motion.exponential(turn)), y

    def variants(self, q, x, given):
        """Each state and its neighbours along every axis, and along every input: [S * V, ...]."""
        n, m = x.shape[1], given.shape[1]
        count = 1 + n + m
        many = lambda v: np.repeat(v[:, None], count, axis=1)
        xs, qs, inputs = many(x), many(q), many(given)
        index = np.arange(3, n)
        xs[:, 1 + index, index] += self.step[3:]
        for k in range(3):
            qs[:, 1 + k] = motion.product(q, motion.exponential(np.broadcast_to(self.step[k] * np.eye(3)[k], (len(q), 3))))
        inputs[:, 1 + n + np.arange(m), np.arange(m)] += 1e-6
        flat = lambda v: v.reshape(v.shape[0] * v.shape[1], v.shape[2])
        return flat(qs), flat(xs), flat(inputs), count

    def slopes(self, values, count, n):
        """First of each state's rows, and slopes over state and inputs."""
        rows = values.reshape(-1, count, values.shape[1])
        over = np.concatenate([self.step, np.full(count - 1 - n, 1e-6)])
        found = np.swapaxes(rows[:, 1:] - rows[:, :1], 1, 2) / over
        return rows[:, 0], found[:, :, :n], found[:, :, n:]

    def predict(self, k):
        n = self.x.shape[1]
        whole_step = self.times_s[k + 1] - self.times_s[k]
        parts = max(1, int(np.ceil(np.linalg.norm(self.rates, axis=1).max() * whole_step / 0.01)))
        h = whole_step / parts
        for part in range(parts):
            t = self.times_s[k] + part * h
            between = lambda s: self.given[:, k] + s * (self.given[:, k + 1] - self.given[:, k])
            now, then = between(part / parts), between((part + 1) / parts)
            qs, xs, _, count = self.variants(self.q, self.x, now[:, :0])
            many = lambda v: np.repeat(v, count, axis=0)
            wrench = self.records[0].mean_wrench(np.array([t]), np.array([t + h]))[0]
            q, x = self.ahead(qs, xs, many(now), many(then), wrench, h)
            self.q, self.x = q[::count], x[::count].copy()
            turn = motion.product(many(self.q) * [-1, -1, -1, 1], q)
            x[:, :3] = 2 * turn[:, :3]
            _, f, _ = self.slopes(x, count, n)
            self.covariance = f @ self.covariance @ np.swapaxes(f, 1, 2)
        walk = self.records[0].sensors.get("gyro", {}).get("walk_rad_s_s05", 0.0)
        self.covariance[:, 12:15, 12:15] += walk**2 * whole_step * np.eye(3)
        noise = self.from_inputs * whole_step**2
        self.covariance[:, :3, :3] += noise[:, :3, :3]
        if self.translating:
            self.covariance[:, 3:6, 3:6] += noise[:, 3:, 3:]

    def update(self, k, rows):
        """`rows`: readings of this time by kind of sensor, [S, 3 or 4]."""
        n, one = self.x.shape[1], self.records[0]
        qs, xs, inputs, count = self.variants(self.q, self.x, self.given[:, k])
        rates, velocity, _ = self.velocities(qs, xs, inputs)
        values, over, by_inputs = self.slopes(np.concatenate([rates, velocity], axis=1), count, n)
        self.rates = values[:, :3]
        self.from_inputs = (by_inputs * self.input_variance) @ np.swapaxes(by_inputs, 1, 2)
        if not rows:
            return
        eye = np.broadcast_to(np.eye(n), (len(self.x), n, n))
        left, h, r = [], [], []
        for kind, read in rows.items():
            plain = np.broadcast_to(one.variance(kind, UNITS[kind]) * np.eye(3), (len(self.x), 3, 3))
            if kind == "gyro":
                left.append(read - values[:, :3] - self.x[:, 12:15])
                h.append(over[:, :3] + eye[:, 12:15])
                plain = plain + self.from_inputs[:, :3, :3]
            elif kind == "attitude":
                turn = motion.product(self.q * [-1, -1, -1, 1], read)
                left.append(2 * turn[:, :3] * np.sign(turn[:, 3:]))
                h.append(eye[:, :3])
                plain = plain + one.sensors[kind].get("slow_rad", 0.0) ** 2 * np.eye(3)
            elif kind == "position":
                left.append(read - self.x[:, 3:6])
                h.append(eye[:, 3:6])
            else:
                left.append(read - values[:, 3:])
                h.append(over[:, 3:])
                plain = plain + self.from_inputs[:, 3:, 3:]
            r.append(plain)
        left, h = np.concatenate(left, axis=1), np.concatenate(h, axis=1)
        noise = np.zeros((len(self.x), left.shape[1], left.shape[1]))
        for j, plain in enumerate(r):
            noise[:, 3 * j : 3 * j + 3, 3 * j : 3 * j + 3] = plain
        gain = np.swapaxes(np.linalg.solve(h @ self.covariance @ np.swapaxes(h, 1, 2) + noise, h @ self.covariance), 1, 2)
        rest = eye - gain @ h
        self.covariance = rest @ self.covariance @ np.swapaxes(rest, 1, 2) + gain @ noise @ np.swapaxes(gain, 1, 2)
        change = motion.times(gain, left)
        self.q = motion.product(self.q, motion.exponential(change[:, :3]))
        self.x[:, 3:] += change[:, 3:]


def readings(records):
    """Of each kind of sensor: sample of the gyro to readings of all seeds."""
    out, times = {}, records[0].times_s
    for kind, file in SENSORS.items():
        if records[0].tables[file] is not None:
            at = np.searchsorted(times, records[0].tables[file][:, 0] - 1e-6)
            values = np.stack([r.tables[file][:, 1:] for r in records])
            out[kind] = {k: values[:, i] for i, k in enumerate(at)}
    return out


def estimate_all(folders):
    """Answers of all seeds of a vehicle."""
    records = [Record(f) for f in folders]
    filtered, seen = Filter(records), readings(records)
    for k in range(len(filtered.times_s)):
        now = {kind: rows[k] for kind, rows in seen.items() if k in rows}
        filtered.update(k, now)
        if k + 1 < len(filtered.times_s):
            filtered.predict(k)
    answers = []
    for s, record in enumerate(records):
        values = filtered.x[s, STATES:]
        sigma = np.sqrt(np.maximum(np.diag(filtered.covariance[s])[STATES:], 0.0))
        good = np.isfinite(values) & np.isfinite(sigma) & (sigma > 0) & (sigma < 0.5 * record.prior)
        answers += record.answers(values, sigma, good)
    return answers
