"""Noisy trials of both steps of Ma et al. (2008) by NumPy: the samples of crates/poinsot-papers/benches/trials.rs, many
trials in one array operation. Normal equations and closed forms as in ours."""

import time

import numpy as np
from scipy.spatial.transform import Rotation

SAMPLES, BASE, ARM, INERTIA, NOISE = 10, 1000.0, 93.184, 166.67, 0.01
REDUCED = BASE * ARM / (BASE + ARM)


def samples():
    t = np.linspace(0.0, 1.0, SAMPLES)
    R = Rotation.from_rotvec(np.c_[0.3 * t, -0.2 * t, 0.5 * t]).as_matrix()
    rho = np.c_[0.5 + 0.6 * np.sin(4 * t), 0.6 * np.cos(5 * t), 0.7 + 0.6 * t * np.sin(3 * t)]
    own = np.c_[12 + 8 * np.sin(3 * t), 15 + 6 * np.cos(2 * t), 9 + 5 * t][:, :, None] * np.eye(3)
    p = np.array([5.5, -3.3, 2.2]) @ R
    h = np.array([2.0, 4.0, 20.0]) @ R
    square = (rho * rho).sum(1)[:, None, None] * np.eye(3) - rho[:, :, None] * rho[:, None, :]
    w = np.linalg.solve(INERTIA * np.eye(3) + own + REDUCED * square, h[..., None])[..., 0]
    v = (p - ARM * np.cross(w, rho)) / (BASE + ARM)
    return rho, own, p, h, v, w


def tensor_rows(w):
    """`I w` as a linear function of the six elements of the tensor."""
    x, y, z = np.moveaxis(w, -1, 0)
    o = np.zeros_like(x)
    rows = [[x, o, o, y, z, o], [o, y, o, x, o, z], [o, o, z, o, x, y]]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def trials(rng, count, fixed):
    rho, own, p, h, v, w = fixed
    noise = rng.standard_normal((2, count, SAMPLES, 3))
    v = v + NOISE * abs(v).max() * noise[0]
    w = w + NOISE * abs(w).max() * noise[1]
    a = v + np.cross(w, rho) - p / ARM
    N = np.empty((count, 4, 4))
    r = np.empty((count, 4))
    N[:, 0, 0] = np.einsum("kli,kli->k", a, a)
    N[:, 0, 1:] = N[:, 1:, 0] = -np.cross(w, a).sum(1)
    ww = np.matmul(w.transpose(0, 2, 1), w)
    N[:, 1:, 1:] = np.trace(ww, axis1=1, axis2=2)[:, None, None] * np.eye(3) - ww
    r[:, 0] = -np.einsum("kli,kli->k", a, v)
    r[:, 1:] = np.cross(w, v).sum(1)
    x = np.linalg.solve(N, r[..., None])[..., 0]
    mass, c = ARM / x[:, 0], x[:, 1:]
    d = c[:, None, :] - rho
    reduced = (mass * ARM / (mass + ARM))[:, None, None]
    arm = np.einsum("lij,klj->kli", own, w)
    y = h - arm - reduced * ((d * d).sum(-1, keepdims=True) * w - (d * w).sum(-1, keepdims=True) * d)
    A = tensor_rows(w).reshape(count, 3 * SAMPLES, 6)
    At = A.transpose(0, 2, 1)
    inertia = np.linalg.solve(np.matmul(At, A), np.matmul(At, y.reshape(count, 3 * SAMPLES, 1)))
    return mass, c, inertia


if __name__ == "__main__":
    rng, fixed = np.random.default_rng(0), samples()
    print(f"numpy_trial_median_mass,{np.median(trials(rng, 50_000, fixed)[0]):.3f},kg")
    # As many trials at once as are fastest.
    for count in (100, 1000, 10_000):
        least = np.inf
        for _ in range(40):
            start = time.thread_time()
            trials(rng, count, fixed)
            least = min(least, time.thread_time() - start)
        print(f"numpy_trial_two_steps_batch_{count},{1e9 * least / count:.0f},ns_min")
