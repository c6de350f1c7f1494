"""Cramer-Rao bound of a record: the least sigma that an unbiased estimator can have.

Readings as functions of the unknown numbers and of the start (pose and twist) are differentiated by central differences of the NumPy
simulator. The noise of joint and wheel sensors acts through the inputs: each sample's input error is a nuisance with its declared
sigma, linear between samples. A Kalman filter of the errors that these cause (attitude and place), of gyro bias and slow tracker
error whitens the readings. An estimator that knows more of the joints, such as that they move smoothly, may do better."""

import numpy as np

from flight import body_with, families, motion, values_of


def turned_by(q, reference):
    """Small rotations from reference to q, in B."""
    turn = motion.product(reference * [-1, -1, -1, 1], q)
    return 2 * turn[..., :3] * np.sign(turn[..., 3:])


def steps_of(family):
    """Steps of the differences, one for each number, then turn, place, twist of the start."""
    steps = [1e-4 * x for x in scales(family)]
    return np.array(steps + [1e-5] * 3 + [1e-4] * 3 + [1e-6] * 6)


def scales(family):
    """Natural unit of each number: the mass, radius of gyration, sqrt(I_ii I_jj)."""
    out = []
    for body, groups in family.unknown.items():
        mass, _, about = (x[0] for x in family.truth[body])
        gyration = np.sqrt(np.trace(about) / (3 * mass))
        elements = [np.sqrt(about[i, i] * about[j, j]) for i, j in families.ELEMENTS.values()]
        out += [mass, gyration, gyration, gyration, *elements] if groups == "true" else elements
    return np.array(out)


def varied(family, offsets):
    """Vehicle and start of each row of offsets."""
    flight, count = family.flight, len(offsets)
    bodies = [tuple(np.broadcast_to(x[0], (count, *x[0].shape)).copy() for x in b) for b in flight.vehicle.bodies]
    at = 0
    for b, groups in family.unknown.items():
        true = values_of(tuple(x[0] for x in bodies[b]), groups)
        for k, row in enumerate(offsets):
            new = body_with(tuple(x[k] for x in bodies[b]), groups, true + row[at : at + len(true)])
            for old, x in zip(bodies[b], new):
                old[k] = x
        at += len(true)
    copy = lambda parts: [tuple(x if isinstance(x, int) else np.repeat(x, count, axis=0) for x in part) for part in parts]
    vehicle = motion.Vehicle(bodies, copy(flight.vehicle.joints), copy(flight.vehicle.wheels))
    attitude, place, twist = (np.repeat(x, count, axis=0) for x in flight.start)
    attitude = motion.product(attitude, motion.exponential(offsets[:, at : at + 3]))
    return vehicle, (attitude, place + offsets[:, at + 3 : at + 6], twist + offsets[:, at + 6 : at + 12])


def sensitivities(family):
    """Slope of rates, turn, place and velocity over numbers and start: kind to [T, 3, parameters]."""
    flight, steps = family.flight, steps_of(family)
    offsets = np.concatenate([np.diag(steps), -np.diag(steps)])
    vehicle, start = varied(family, offsets)
    inputs = lambda t: tuple(np.repeat(x, len(offsets), axis=0) for x in flight.inputs(t))
    found = motion.fly(vehicle, inputs, start, flight.times_s, flight.step_s, flight.wrench, flight.torque)
    found[0] = turned_by(found[0], flight.attitude)
    half = len(steps)
    slope = lambda x: np.moveaxis((x[:half] - x[half:]) / (2 * steps[:, None, None]), 0, -1)
    return dict(zip(["attitude", "place", "rates", "velocity"], map(slope, found)))


def input_slopes(family):
    """Slopes of rates (B) and velocity (N) over errors of attitude and place, [T, 6, 6], and over the inputs: angles, joint rates,
    wheel speeds, [T, 6, n]."""
    flight = family.flight
    times, count = flight.times_s, len(flight.times_s)
    given = [np.concatenate(x) for x in zip(*(flight.inputs(t) for t in times))]
    sizes = [x.shape[1] for x in given]
    repeat = lambda parts: [tuple(x if isinstance(x, int) else np.repeat(x, count, axis=0) for x in part) for part in parts]
    vehicle = motion.Vehicle(repeat(flight.vehicle.bodies), repeat(flight.vehicle.joints), repeat(flight.vehicle.wheels))
    turned = motion.matrix(flight.attitude)
    back = np.swapaxes(turned, -1, -2)
    whole, moving = vehicle.momentum_map(*given)
    twist = np.concatenate([flight.rates, motion.times(back, flight.velocity)], axis=1)
    inside = motion.times(whole, twist) + moving
    linear = motion.times(turned, inside[:, 3:])
    angular = motion.times(turned, inside[:, :3]) + np.cross(flight.place, linear)

    def velocities(offset):
        turn = turned @ motion.matrix(motion.exponential(np.broadcast_to(offset[:3], (count, 3))))
        about = angular - np.cross(flight.place + offset[3:6], linear)
        now = np.concatenate([motion.times(np.swapaxes(turn, -1, -2), x) for x in (about, linear)], axis=1)
        shifted, at = [], 6
        for values, size in zip(given, sizes):
            shifted.append(values + offset[at : at + size])
            at += size
        whole, moving = vehicle.momentum_map(*shifted)
        v = np.linalg.solve(whole, (now - moving)[..., None])[..., 0]
        return np.concatenate([v[:, :3], motion.times(turn, v[:, 3:])], axis=1)

    step = 1e-5
    columns = []
    for k in range(6 + sum(sizes)):
        offset = np.zeros(6 + sum(sizes))
        offset[k] = step
        columns.append((velocities(offset) - velocities(-offset)) / (2 * step))
    slopes = np.stack(columns, axis=-1)
    return slopes[:, :, :6], slopes[:, :, 6:], sizes


def variance(sensor, unit):
    return sensor.get(f"noise_{unit}", 0.0) ** 2 + sensor.get(f"quantisation_{unit}", 0.0) ** 2 / 12


UNITS = {"gyro": "rad_s", "attitude": "rad", "position": "m", "velocity": "m_s", "joint_position": "rad", "joint_rate": "rad_s", "wheel_speed": "rad_s"}


def information(family, model, rows_of):
    """Information matrix of numbers and start. `rows_of`: kind of sensor to its times."""
    flight = family.flight
    times = flight.times_s
    sensors = {s["type"]: s for s in model["sensor"]}
    slopes = sensitivities(family)
    through, by_inputs, sizes = input_slopes(family)
    noise = np.concatenate(
        [np.full(n, variance(sensors.get(k, {}), UNITS[k])) for n, k in zip(sizes, ("joint_position", "joint_rate", "wheel_speed"))]
    )
    n, columns = len(noise), slopes["rates"].shape[2]
    seen = {kind: set(np.rint(at / (times[1] - times[0])).astype(int)) for kind, at in rows_of.items()}
    # State: turn, place, gyro bias, slow tracker error, input errors of this sample.
    size = 12 + n
    tracker, gyro = sensors.get("attitude", {}), sensors.get("gyro", {})
    slow, walk, h = tracker.get("slow_rad", 0.0), gyro.get("walk_rad_s_s05", 0.0), times[1] - times[0]
    stays = np.exp(-h / tracker["correlation_s"]) if slow else 0.0
    covariance = np.diag(np.concatenate([np.zeros(6), np.full(3, 1.0), np.full(3, slow**2), noise]))
    state, total = np.zeros((size, columns)), np.zeros((columns, columns))
    eye = np.eye(size)
    for k in range(len(times)):
        reads = {
            "gyro": (np.hstack([through[k, :3], np.eye(3), np.zeros((3, 3)), by_inputs[k, :3]]), slopes["rates"][k]),
            "attitude": (np.hstack([np.eye(3, 9), np.eye(3), np.zeros((3, n))]), slopes["attitude"][k]),
            "position": (np.eye(6, size)[3:], slopes["place"][k]),
            "velocity": (np.hstack([through[k, 3:], np.zeros((3, 6)), by_inputs[k, 3:]]), slopes["velocity"][k]),
        }
        used = [kind for kind in seen if k in seen[kind]]
        if used:
            h_of, x = np.vstack([reads[u][0] for u in used]), np.vstack([reads[u][1] for u in used])
            r = np.concatenate([np.full(3, variance(sensors[u], UNITS[u])) for u in used])
            spread = h_of @ covariance @ h_of.T + np.diag(r)
            gain = np.linalg.solve(spread, h_of @ covariance).T
            left = x - h_of @ state
            total += left.T @ np.linalg.solve(spread, left)
            state = state + gain @ left
            covariance = (eye - gain @ h_of) @ covariance @ (eye - gain @ h_of).T + gain @ np.diag(r) @ gain.T
        if k + 1 == len(times):
            break
        # Trapezoid: errors of rates and velocity now and at the next sample.
        turn = np.eye(6)
        turn[:3, :3] = motion.matrix(motion.exponential(-h * (flight.rates[k] + flight.rates[k + 1]) / 2))
        ahead = np.linalg.inv(np.eye(6) - h / 2 * through[k + 1])
        move, fresh = np.zeros((size, size)), np.zeros((size, n))
        move[:6, :6] = ahead @ turn @ (np.eye(6) + h / 2 * through[k])
        move[:6, 12:] = ahead @ turn @ by_inputs[k] * h / 2
        move[6:9, 6:9], move[9:12, 9:12] = np.eye(3), stays * np.eye(3)
        fresh[:6], fresh[12:] = ahead @ by_inputs[k + 1] * h / 2, np.eye(n)
        state = move @ state
        covariance = move @ covariance @ move.T + (fresh * noise) @ fresh.T
        covariance[6:9, 6:9] += walk**2 * h * np.eye(3)
        covariance[9:12, 9:12] += (1 - stays**2) * slow**2 * np.eye(3)
    return total


def bound(family, model, rows_of):
    """Least sigma of each number, infinite where it would be the natural unit or more: how much more, round-off decides."""
    unit = np.concatenate([scales(family), np.full(6, 1.0), np.full(6, 1.0)])
    matrix = information(family, model, rows_of) * np.outer(unit, unit)
    # A prior far wider than any data, so that directions that nothing determines have a finite inverse.
    width = np.concatenate([np.full(len(unit) - 12, 1e5), np.full(12, 10.0)])
    variances = np.diag(np.linalg.inv(matrix + np.diag(width**-2.0)))[:-12]
    # Round-off makes the variance of what nothing determines negative at times.
    sigma = np.sqrt(np.where(variances > 0, variances, np.inf)) * unit[:-12]
    return np.where(sigma < unit[:-12], sigma, np.inf)
