"""Linear identification of the benchmark arm with NumPy and SciPy: regressor vectorised over the samples,
QR for the triangle, pivoted QR of the triangle for the base columns, solution.  Prints name,value,unit.

usage: numpy_least_squares.py [SAMPLES]       10^6 samples need 10 GB
       numpy_least_squares.py regressor       the regressor alone, over 4,096 states
"""
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import resource
import sys
import time

import numpy as np
import scipy.linalg

MASS = [400, 12, 10, 10, 8, 6, 30]
CENTRE = np.array([[0, 0, 0], [0, 0, .150], [.270, 0, -.251], [0, 0, .150], [0, 0, -.350], [0, -.034, 0],
                   [-.270, 0, .430]])
NEXT = np.array([[.357, -.010, .419], [0, 0, .150], [.560, 0, -.049], [0, 0, .150], [0, 0, -.700], [0, -.066, 0]])
# Ixx Iyy Izz Ixy Ixz Iyz about the mass centre
INERTIA = [[30, 28, 32, .260, .370, -.290], [.510, .510, .200, 0, 0, 0], [.278, 1.811, 1.690, 0, .263, 0],
           [.420, .420, .150, 0, 0, 0], [.500, .500, .210, 0, 0, 0], [.330, .172, .260, 0, 0, 0],
           [2.398, 2.678, 1.405, -.069, .013, .051]]
ROLL = [0, 1, 0, -1, 1, -1]  # quarter turns about x
SIGMA = 1e-4


def skew(a):
    """N x 3 to N x 3 x 3."""
    out = np.zeros((len(a), 3, 3))
    out[:, 2, 1], out[:, 0, 2], out[:, 1, 0] = a[:, 0], a[:, 1], a[:, 2]
    return out - out.transpose(0, 2, 1)


def regressor(q, rates, v, w):
    """Momentum about the base origin in base axes per unit parameter, N x 6 x 70."""
    n = len(q)
    Y = np.zeros((n, 6, 70))
    R = np.broadcast_to(np.eye(3), (n, 3, 3))
    p = np.zeros((n, 3))
    for i in range(7):
        if i > 0:
            roll = ROLL[i - 1] * np.pi / 2
            turn_x = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
            turn_z = np.zeros((n, 3, 3))
            turn_z[:, 0, 0] = turn_z[:, 1, 1] = np.cos(q[:, i - 1])
            turn_z[:, 1, 0] = np.sin(q[:, i - 1])
            turn_z[:, 0, 1] = -turn_z[:, 1, 0]
            turn_z[:, 2, 2] = 1
            arm = R @ (CENTRE[i - 1] + NEXT[i - 1])
            v, p = v + np.cross(w, arm), p + arm
            R = R @ (turn_x @ turn_z)
            w = w + R[:, :, 2] * rates[:, i - 1:i]
        body = Y[:, :, 10 * i:10 * i + 10]
        first = skew(w) @ R  # linear momentum per first moment
        body[:, :3, 0] = v
        body[:, 3:, 0] = np.cross(p, v)
        body[:, :3, 1:4] = first
        body[:, 3:, 1:4] = skew(p) @ first - skew(v) @ R
        s = (w[:, None, :] @ R)[:, 0]  # rate about each body axis
        for column, (a, b) in enumerate([(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)], 4):
            body[:, 3:, column] = R[:, :, a] * s[:, b:b + 1]
            if a != b:
                body[:, 3:, column] += R[:, :, b] * s[:, a:a + 1]
    return Y


def parameters():
    out = []
    for m, c, (xx, yy, zz, xy, xz, yz) in zip(MASS, CENTRE, INERTIA):
        I = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) + m * (c @ c * np.eye(3) - np.outer(c, c))
        out += [m, *(m * c), I[0, 0], I[0, 1], I[1, 1], I[0, 2], I[1, 2], I[2, 2]]
    return np.array(out)


def states(samples):
    rng = np.random.default_rng(1)
    q, rates = rng.uniform(-2, 2, (samples, 6)), rng.uniform(-.5, .5, (samples, 6))
    v, w = rng.uniform(-.1, .1, (samples, 3)), rng.uniform(-.1, .1, (samples, 3))
    return rng, q, rates, v, w


def regressor_alone(samples=4096, repeats=20):
    _, *at = states(samples)
    times = []
    for _ in range(repeats):
        start = time.thread_time()
        regressor(*at)
        times.append(time.thread_time() - start)
    print(f"numpy_momentum_regressor_6x70,{min(times) / samples * 1e9:.1f},ns_min")


def main():
    if sys.argv[1:] == ["regressor"]:
        return regressor_alone()
    samples = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    rng, q, rates, v, w = states(samples)
    clock = time.thread_time  # processor time: what others do on the machine does not count
    start = clock()
    A = regressor(q, rates, v, w).reshape(6 * samples, 70)
    built = clock() - start
    y = A @ parameters() + SIGMA * rng.standard_normal(6 * samples)
    start = clock()
    # The triangle of [A | y] holds all that is asked; without y for the base columns alone.
    triangle = np.linalg.qr(np.column_stack([A, y]), mode="r")
    _, r, order = scipy.linalg.qr(triangle[:, :70], mode="economic", pivoting=True)
    diagonal = abs(np.diag(r))
    base = order[:int((diagonal > 1e-9 * diagonal[0]).sum())]
    x, *_ = np.linalg.lstsq(triangle[:, base], triangle[:, 70], rcond=None)
    solved = clock() - start
    rms = np.linalg.norm(triangle[:, base] @ x - triangle[:, 70]) / np.sqrt(6 * samples)
    name = f"numpy_least_squares_{samples}_samples"
    print(f"{name}_processor,{built + solved:.3f},s")
    print(f"{name}_regressor,{built:.3f},s")
    print(f"{name}_base_columns,{len(base)},columns")
    print(f"{name}_residual_rms,{rms:.4e},N s")
    print(f"{name}_peak_memory,{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.1f},MiB")


if __name__ == "__main__":
    main()
