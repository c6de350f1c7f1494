"""Linear least squares with differentiated rates: Euler's and Newton's equations for a tree, no model of noise.

Momentum of the vehicle about the base's origin, in B, is linear in mass, first moment and tensor of each unknown body. Its derivative
(a local parabola through the samples, Savitzky and Golay 1964) plus the transport terms equals the thrusters' wrench. Sigma is that of
ordinary least squares from the scatter of the residuals; a number whose sigma exceeds half of its prior is refused."""

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.signal import savgol_filter

from common import ELEMENTS, Record, motion

WINDOW_S = 1.0


def rates_of(record):
    """Times and rates: of the gyro without its mean offset from the tracker, of the tracker where there is no gyro."""
    st = record.tables["st"]
    turn = motion.product(st[:-1, 1:] * [-1, -1, -1, 1], st[1:, 1:])
    mean = 2 * turn[:, :3] * np.sign(turn[:, 3:]) / np.diff(st[:, 0])[:, None]
    middle = (st[1:, 0] + st[:-1, 0]) / 2
    gyro = record.tables["gyro"]
    if gyro is None:
        return middle[1:-1], mean[1:-1]
    inside = np.stack([np.interp(middle, gyro[:, 0], gyro[:, 1 + i]) for i in range(3)], axis=1)
    close = np.diff(st[:, 0]) < 2 * np.median(np.diff(st[:, 0]))
    # Only where the vehicle turns so little in a sample that means and samples are alike.
    slow = np.linalg.norm(mean[close], axis=1).max() * np.diff(st[:, 0])[close].max() < 0.1
    bias = np.median((inside - mean)[close], axis=0) if slow else 0.0
    return gyro[:, 0], gyro[:, 1:] - bias


def at_times(times, table):
    return np.stack([np.interp(times, table[:, 0], table[:, 1 + i]) for i in range(table.shape[1] - 1)], axis=1)


def unit_bodies(record):
    """Of each linear parameter: the bodies that have it alone, as (mass, centre, tensor about the centre) with its sign."""
    for b, whole in record.unknown.items():
        if whole:
            yield b, [(1.0, 1.0, np.zeros(3), np.zeros((3, 3)))]
            for axis in np.eye(3):
                s = motion.cross_matrix(axis)
                yield b, [(1.0, 1.0, axis, s @ s), (-1.0, 1.0, np.zeros(3), np.zeros((3, 3)))]
        for i, j in ELEMENTS.values():
            about = np.zeros((3, 3))
            about[i, j] = about[j, i] = 1.0
            yield b, [(1.0, 0.0, np.zeros(3), about)]


def momentum(record, bodies, given, twist, wheels):
    """Of some bodies alone, [T, 6]."""
    count = len(twist)
    full = [tuple(np.broadcast_to(x, (count, *np.shape(x))) for x in b) for b in bodies]
    spread = lambda parts: [tuple(x if isinstance(x, int) else np.repeat(x, count, axis=0) for x in p) for p in parts]
    whole, moving = motion.Vehicle(full, spread(record.joints), spread(wheels)).momentum_map(*given)
    return motion.times(whole, twist) + moving, whole, moving


def columns(record, given, twist):
    """Momentum of what is known [T, 6], and per linear parameter [T, 6, n]."""
    blank = (0.0, np.zeros(3), np.zeros((3, 3)))
    plain = [tuple(x[0] for x in b) for b in record.bodies]
    known = list(plain)
    for b, whole in record.unknown.items():
        known[b] = blank if whole else (*plain[b][:2], np.zeros((3, 3)))
    fixed, *_ = momentum(record, known, given, twist, record.wheels)
    found = []
    for b, parts in unit_bodies(record):
        total = 0.0
        for sign, *body in parts:
            alone = [blank] * len(plain)
            alone[b] = tuple(body)
            total = total + sign * momentum(record, alone, given, twist, [])[0]
        found.append(total)
    return fixed, np.stack(found, axis=-1)


def physical(record, linear):
    """Mass, centre and tensor about the centre from mass, first moment and tensor about the origin."""
    out, at = [], 0
    for whole in record.unknown.values():
        if whole:
            mass, centre = linear[at], linear[at + 1 : at + 4] / linear[at]
            s = motion.cross_matrix(centre)
            shift = mass * s @ s
            out += [mass, *centre, *(linear[at + 4 + k] + shift[ij] for k, ij in enumerate(ELEMENTS.values()))]
        else:
            out += list(linear[at : at + 6])
        at += 10 if whole else 6
    return np.array(out)


def solve(record):
    times, rates = rates_of(record)
    angles, joint_rates, speeds, _ = record.inputs()
    given = [x if not x.shape[1] else at_times(times, np.column_stack([record.times_s, x])) for x in (angles, joint_rates, speeds)]
    given = [np.zeros((len(times), 0)) if not x.shape[1] else x for x in given]
    translating = record.tables["vel"] is not None
    if translating:
        # On the samples of the velocity.
        keep = np.isin(np.round(times, 6), np.round(record.tables["vel"][:, 0], 6))
        times, rates, given = times[keep], rates[keep], [x[keep] for x in given]
        st = record.tables["st"]
        attitude = st[np.searchsorted(st[:, 0], times - 1e-6), 1:]
        back = np.swapaxes(motion.matrix(attitude), -1, -2)
        linear = motion.times(back, record.tables["vel"][:, 1:])
    else:
        # About the mass centre at rest: masses are known.
        plain = [tuple(x[0] for x in b) for b in record.bodies]
        _, whole, moving = momentum(record, plain, given, np.zeros((len(times), 6)), [])
        linear = -(motion.times(whole[:, 3:, :3], rates) + moving[:, 3:]) / whole[:, 3, 3][:, None]
    twist = np.concatenate([rates, linear], axis=1)
    fixed, per = columns(record, given, twist)
    h = np.median(np.diff(times))
    window = max(3, 2 * int(WINDOW_S / h / 2) + 1)
    # All that is differentiated is summed up first, so that the same window acts on momentum and wrench.
    slope = lambda x: savgol_filter(x, window, 2, deriv=1, delta=h, axis=0)

    def balance(x):
        """Derivative in N, in B: torque about the base's origin, force."""
        vectors = x if x.ndim == 3 else x[..., None]
        w, v = motion.cross_matrix(twist[:, :3]), motion.cross_matrix(twist[:, 3:])
        turned = np.concatenate([w @ vectors[:, :3] + v @ vectors[:, 3:], w @ vectors[:, 3:]], axis=1)
        return slope(vectors + cumulative_trapezoid(turned, times, axis=0, initial=0)).reshape(x.shape)

    impulse = record.mean_wrench(times[:-1], times[1:]) * np.diff(times)[:, None]
    push = slope(np.concatenate([np.zeros((1, 6)), np.cumsum(impulse, axis=0)]))
    rows, right = balance(per), push - balance(fixed)
    used = slice(0, 6) if translating else slice(0, 3)
    if not translating:
        centre = np.stack([whole[:, 2, 4], whole[:, 0, 5], whole[:, 1, 3]], axis=-1) / whole[:, 3, 3][:, None]
        right[:, :3] -= np.cross(centre, push[:, 3:])
    edge = slice(window // 2, len(times) - window // 2)
    a, b = rows[edge, used].reshape(-1, rows.shape[2]), right[edge, used].reshape(-1)
    # Torques and forces have scatters of their own: weighted by those of a first solution.
    weight = np.ones(len(b))
    for _ in range(3):
        x, *_ = np.linalg.lstsq(a * weight[:, None], b * weight, rcond=None)
        rest = (b - a @ x).reshape(-1, rows[0, used].shape[0])
        weight = np.broadcast_to(1 / np.maximum(np.std(rest, axis=0), 1e-12), rest.shape).reshape(-1)
    # Samples of a window share their noise.
    covariance = np.linalg.pinv((a * weight[:, None]).T @ (a * weight[:, None])) * window
    values = physical(record, x)
    slopes = np.stack([(physical(record, x + d) - physical(record, x - d)) / 2e-4 for d in 1e-4 * np.eye(len(x))], axis=1)
    return values, np.sqrt(np.diag(slopes @ covariance @ slopes.T))


def estimate(folder):
    record = Record(folder)
    values, sigma = solve(record)
    good = np.isfinite(values) & np.isfinite(sigma) & (sigma > 0) & (sigma < 0.5 * record.prior)
    return record.answers(values, sigma, good)
