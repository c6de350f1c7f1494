"""Xu, Hu, Zhang and Liang 2017 by code that is not ours: what momentum determines of the 70 numbers, how much of the error of
Tables 6 to 12 lies outside it, how tight (75) is, and one joint beside all joints at once.

    python3 validation/papers/xu2017.py > validation/papers/xu2017.json
"""

import json
import tomllib

import numpy as np

from tree import DATA, Tree, fly

RATE = 0.03
DRAWS = 200_000
STEP = 0.1


def largest():
    """Largest of each coefficient of L = A I A^T w in the six elements, by differentiation, random attitudes and rates."""
    rng = np.random.default_rng(75)
    q = rng.normal(size=(DRAWS, 4))
    q /= np.linalg.norm(q, axis=1)[:, None]
    x, y, z, s = q.T
    A = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)],
        [2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)],
        [2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)
    w = rng.normal(size=(DRAWS, 3))
    w *= RATE / np.linalg.norm(w, axis=1)[:, None]
    out = {a: [] for a in "xyz"}
    for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
        E = np.zeros((3, 3))
        E[i, j] = E[j, i] = 1
        L = np.einsum("nij,jk,nlk,nl->ni", A, E, A, w)
        for k, a in enumerate("xyz"):
            out[a].append(float(abs(L[:, k]).max()))
    return out


def fourier(motions):
    def at(t):
        q, qd = np.zeros(6), np.zeros(6)
        for j, (f, sine, cosine) in motions.items():
            for k, (a, b) in enumerate(zip(sine, cosine), 1):
                o = 2 * np.pi * f * k
                q[j] += a * np.sin(o * t) + b * np.cos(o * t)
                qd[j] += o * (a * np.cos(o * t) - b * np.sin(o * t))
        return q, qd

    return at


ELEMENTS = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


def ten(m, com, I):
    """Mass, first moment and inertia about the body's origin from mass, mass centre and central inertia."""
    Io = I + m * (com @ com * np.eye(3) - np.outer(com, com))
    return np.r_[m, m * com, [Io[e] for e in ELEMENTS]]


def natural(m, I):
    L = np.sqrt(np.trace(I) / (2 * m))
    return np.r_[m, [m * L] * 3, [m * L * L] * 6]


def momentum_of_ten(B, o, v, w):
    """What each of a body's ten numbers adds to the momentum about the inertial origin; B its axes, o its origin."""
    columns = []
    for k in range(10):
        m, mc, I = 0.0, np.zeros(3), np.zeros((3, 3))
        if k == 0:
            m = 1.0
        elif k < 4:
            mc[k - 1] = 1.0
        else:
            i, j = ELEMENTS[k - 4]
            I[i, j] = I[j, i] = 1.0
        P = m * v + np.cross(w, B @ mc)
        columns.append(np.r_[P, np.cross(o, P) + np.cross(B @ mc, v) + B @ (I @ (B.T @ w))])
    return np.array(columns).T


# Tables 6 to 12, "identification value": mass; xx, yy, zz, xy, xz, yz; mass centre.
IDENTIFIED = [
    [399.9415, 30.117, 28.109, 31.993, 0.259, 0.335, -0.289, -5.22e-5, 1.39e-6, 2.0e-4],
    [12.010, 0.523, 0.519, 0.196, 9.1e-11, 6.0e-4, -6.36e-9, 3.0e-4, -1.8e-14, 0.140],
    [9.966, 0.285, 1.817, 1.689, 9.41e-9, 0.257, 5.1e-11, 0.272, -1.30e-13, -0.252],
    [10.007, 0.414, 0.404, 0.141, 8.8e-13, 8.0e-4, -6.5e-13, -5.0e-4, 3.0e-15, 0.149],
    [7.908, 0.509, 0.501, 0.218, 6.5e-13, -4.7e-13, 1.4e-10, 1.0e-15, 1.4e-8, -0.346],
    [6.069, 0.323, 0.164, 0.261, -1.8e-13, -4.6e-14, 3.7e-9, -4.0e-15, -0.033, -1.9e-8],
    [30.009, 2.395, 2.676, 1.405, -0.068, 0.014, 0.051, -0.270, -2.2e-8, 0.429],
]


def determined():
    """Rank of the momentum of random motions in the 70 numbers, its gap, and where the error of Tables 6 to 12 lies."""
    tree = Tree("cases/xu2017_truth.toml")
    rng, bodies = np.random.default_rng(52), range(len(tree.mass))
    unit = np.concatenate([natural(tree.mass[b], tree.inertia[b]) for b in bodies])
    rows = []
    for _ in range(100):
        v, w = rng.normal(size=(2, 3))
        R, p, wr, vr = tree.relative(rng.normal(size=6), rng.normal(size=6))
        body = lambda b: momentum_of_ten(R[b], p[b], v + np.cross(w, p[b]) + vr[b], w + wr[b])
        rows.append(np.hstack([body(b) for b in bodies]) * unit)
    _, s, vt = np.linalg.svd(np.vstack(rows))
    rank = int((s > 1e-10 * s[0]).sum())
    error = []
    for b, x in zip(bodies, IDENTIFIED):
        I = np.array([[x[1], x[4], x[5]], [x[4], x[2], x[6]], [x[5], x[6], x[3]]])
        error.append(ten(x[0], np.array(x[7:]), I) - ten(tree.mass[b], tree.com[b], tree.inertia[b]))
    error = np.concatenate(error) / unit
    seen = vt[:rank] @ error
    single = [int((abs(vt[rank:, 10 * b : 10 * b + 10]).max(0) < 1e-9).sum()) for b in bodies]
    return {
        "rank": rank,
        "gap": [float(s[rank - 1] / s[0]), float(s[rank] / s[0])],
        "error_undetermined": float(1 - seen @ seen / (error @ error)),
        "sum_of_masses": sum(x[0] for x in IDENTIFIED),
        "single_barycentric_numbers": sum(single),
    }


def target(joints):
    """Momentum rows of the last body's ten numbers from rest, 60 s at 10 Hz: condition and error of the solution."""
    tree = Tree("cases/xu2017_target.toml")
    times = np.arange(601) / 10
    zero = np.zeros(3)
    start = tree.momentum(zero, zero, *joints(0.0))[2]
    last = len(tree.mass) - 1
    rows, right = [], []
    for R, v, w, q, qd in fly(tree, zero, zero, joints, times, STEP):
        whole_P, whole_H, c = tree.momentum(v, w, q, qd)
        place = start - R @ c  # the mass centre rests
        Rb, p, wr, vr = tree.relative(q, qd)
        B, o = R @ Rb[last], place + R @ p[last]
        wb = R @ (w + wr[last])
        vb = R @ (v + np.cross(w, p[last]) + vr[last])
        rows.append(momentum_of_ten(B, o, vb, wb))
        P = R @ whole_P
        right.append(np.r_[P, R @ whole_H + np.cross(place, P)])
    rows, right = np.array(rows), np.array(right)
    m, com, I = tree.mass[last], tree.com[last], tree.inertia[last]
    true = ten(m, com, I)
    # What the rest of the vehicle has follows from the whole; the constant momentum is unknown.
    rest = right - rows @ true
    A = (rows - rows.mean(0)).reshape(-1, 10)
    b = -(rest - rest.mean(0)).reshape(-1)
    # Natural units of the nominal numbers: mass times 1.2, central tensor times 1.3.
    unit = natural(1.2 * m, 1.3 * I)
    s = np.linalg.svd(A * unit, compute_uv=False)
    found = np.linalg.lstsq(A * unit, b, rcond=None)[0] * unit
    return {"condition": float(s[0] / s[-1]), "error": float(abs((found - true) / unit).max())}


def main():
    case = tomllib.loads((DATA / "cases/xu2017_target_all_joints.toml").read_text())
    every = {
        int(j["joint"][5:]) - 1: (j["base_frequency_hz"], j["sine_rad"], j["cosine_rad"]) for j in case["joint_motion"]
    }
    alone = {5: (1 / 60, [np.radians(30)], [0.0])}
    out = {"determined": determined(), "largest": largest(), "alone": target(fourier(alone)), "together": target(fourier(every))}
    print(json.dumps(out, indent=1))


main()
