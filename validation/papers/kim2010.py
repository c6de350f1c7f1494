"""Kim, Choi and Oh 2010 by code that is not ours: the four columns on one slew and on three, and the inversion of Table 2.

    python3 validation/papers/kim2010.py > validation/papers/kim2010.json

At zero momentum with gains proportional to the inertia, (1a) and (17) are w' = -2 wn^2 q_e - 2 zeta wn w: the motion does not
depend on the inertia, and Q = I w.
"""

import json

import numpy as np

TRUE = np.array([[13.916, 0.0850, 0.1330], [0.0850, 16.954, 0.5896], [0.1330, 0.5896, 19.894]])
PRINTED = {
    "batch": [4.2859, 7.1157, 6.1224, 4.8224, 6.1667, 6.2786],
    "conventional": [14.1181, 17.5350, 20.6816, 16.3578, 19.1201, 17.4000],
    "suggested": [14.1181, 17.5350, 20.6816, 0.1197, 0.1538, 0.1560],
}
# xx, yy, zz, xy, yz, zx: the order of Table 2.
ORDER = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)]
ZETA, DURATION, RATE = 0.707, 350.0, 10


def product(a, b):
    return np.r_[a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3]), a[3] * b[3] - a[:3] @ b[:3]]


def slew(wn, targets):
    """Rates at RATE from rest, torque held between samples; targets are (time, quaternion xyzw), the first from time zero."""
    h, q, w, out = 1 / RATE, np.r_[0.0, 0, 0, 1], np.zeros(3), []
    for k in range(int(DURATION * RATE) + 1):
        out.append(w)
        target = np.array([to for t, to in targets if t <= k * h + 1e-9][-1], float)
        error = product(np.r_[-target[:3], target[3]], q)
        a = -2 * wn**2 * np.sign(error[3]) * error[:3] - 2 * ZETA * wn * w
        slope = lambda x, t: product(x, np.r_[w + a * t, 0]) / 2
        k1 = slope(q, 0)
        k2 = slope(q + h / 2 * k1, h / 2)
        k3 = slope(q + h / 2 * k2, h / 2)
        q = q + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(q + h * k3, h))
        q, w = q / np.linalg.norm(q), w + a * h
    return np.array(out)


def estimators(G, K):
    """The columns of Table 2 from the sums of w w^T and Q w^T."""
    d, pairs = np.diag(G), [(i, j) for i in range(3) for j in range(3) if i != j]
    batch = K @ np.linalg.pinv(G, rcond=1e-10)
    moments = np.diag(K) / d
    alone, first, given = np.diag(moments), np.diag(moments), np.diag(moments)
    for i, j in pairs:
        alone[i, j] = K[i, j] / d[j]
        first[i, j] = (K[i, j] - moments[i] * G[i, j]) / d[j]
    for i, j in pairs:
        o = 3 - i - j
        other = 0.0 if (i, j) == (0, 2) else first[i, o] * G[o, j]
        given[i, j] = (K[i, j] - moments[i] * G[i, j] - other) / d[j]
    mean = lambda I: [float(I[i, j] + I[j, i]) / 2 for i, j in ORDER]
    return {
        "batch": [float(batch[i, j]) for i, j in ORDER],
        "conventional": mean(alone),
        "pre-estimate": mean(given),
        "suggested": mean(first),
    }


def columns(w):
    G = w.T @ w
    return estimators(G, TRUE @ G)


def inversion(w):
    """Eight unknowns from 15 printed numbers: G and k with K = (I n) k^T; then the column considering pre-estimate."""
    n = np.linalg.svd(w)[2][0]
    n *= np.sign(n[0])
    g, wanted = TRUE @ n, np.r_[PRINTED["batch"], PRINTED["conventional"], PRINTED["suggested"][3:]]
    upper = np.triu_indices(3)

    def sums(u):
        G = np.zeros((3, 3))
        G[upper] = u[:6]
        return G + np.triu(G, 1).T, np.outer(g, np.r_[u[6:], n[2]])

    def numbers(u):
        e = estimators(*sums(u))
        return np.r_[e["batch"], e["conventional"], e["suggested"][3:]]

    u = np.r_[(np.outer(n, n) + 2.7e-3 * np.eye(3))[upper], n[:2]]
    for _ in range(30):
        J = np.array([(numbers(u + s) - numbers(u - s)) / 2e-7 for s in 1e-7 * np.eye(8)]).T
        u = u + np.linalg.lstsq(J, wanted - numbers(u), rcond=None)[0]
    G, K = sums(u)
    return {
        "worst_half_digits": float(abs(wanted - numbers(u)).max() / 0.5e-4),
        "pre_estimate": estimators(G, K)["pre-estimate"][3:],
    }


def three():
    """Slews of 17 deg about x, y, z, one after the other: attitudes after each."""
    s, c = np.sin(np.radians(17) / 2), np.cos(np.radians(17) / 2)
    turns = [np.r_[s, 0, 0, c], np.r_[0, s, 0, c], np.r_[0, 0, s, c]]
    first, second = turns[0], product(turns[0], turns[1])
    return [(0, first), (117, second), (233, product(second, turns[2]))]


def main():
    # From Euler angles (10, 10, 10) deg, 3-2-1, to zero: the way back has the same axis with the sign reversed.
    half = np.radians(10) / 2
    s, c = np.sin(half), np.cos(half)
    start = product(product(np.r_[0, 0, s, c], np.r_[0, s, 0, c]), np.r_[s, 0, 0, c])
    one = slew(0.043, [(0, np.r_[-start[:3], start[3]])])
    out = {
        "one": columns(one),
        "inversion": inversion(one),
        "17deg": columns(slew(0.034, three())),
    }
    print(json.dumps(out, indent=1))


main()
