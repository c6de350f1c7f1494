"""Ma, Dang and Pham 2008 by code that is not ours: noise, offsets and biases in both options, and bounds of claims.

    python3 validation/papers/ma2008.py > validation/papers/ma2008.json

The motion follows from conservation of momentum, the two steps are numpy.linalg.lstsq, and the bound differentiates the
velocities as explicit functions of the unknowns (the project differentiates implicit equations).
"""

import json

import numpy as np

from tree import Tree, fly

UP, DOWN = [0, -90, 180, 0, 0, 0], [0, -180, 180, 0, 0, 0]
KNOTS = [(0, [0] * 6), (5, [0] * 6), (45, UP), (75, DOWN), (125, [150, -180, 180, 0, 0, 0]), (135, [150, -180, 180, 0, 0, 0])]
# Trajectory 2: stretch up and fold back.
BACK = [(0, [0] * 6), (5, [0] * 6), (45, UP), (85, [0] * 6), (90, [0] * 6)]
STEP = 0.2
DRAWS = 1000


def quintic(times, values):
    """Through the values, at rest at each: angles and rates as a function of time."""
    times, values = np.array(times, float), np.array(values, float)

    def at(t):
        k = int(np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2))
        h = times[k + 1] - times[k]
        s = np.clip((t - times[k]) / h, 0, 1)
        d = values[k + 1] - values[k]
        return values[k] + d * (10 * s**3 - 15 * s**4 + 6 * s**5), d * (30 * s**2 - 60 * s**3 + 30 * s**4) / h

    return at


class Run:
    """Ten stopped samples of a trajectory, spin in deg/s."""

    def __init__(self, spin=(0, 0, 5), factor=1.0, ratio=None, moves=None, path=KNOTS):
        self.tree = Tree("cases/ma2008_truth.toml")
        if ratio:
            scale = ratio * self.tree.mass[0] / self.tree.mass[1:].sum()
            self.tree.mass[1:] *= scale
            self.tree.inertia[1:] *= scale
        knots = np.array([k[1] for k in path], float) * factor
        if moves is not None:
            for j in range(6):
                if j not in moves:
                    knots[:, j] = 0
        smooth = quintic([k[0] for k in path], np.radians(knots))
        times = np.linspace(path[1][0], path[-2][0], 10)
        stops = np.unique(np.r_[[k[0] for k in path], times])
        joints = quintic(stops, [smooth(t)[0] for t in stops])
        w = np.radians(spin)
        q, qd = joints(0.0)
        P, H, c = self.tree.momentum(np.zeros(3), w, q, qd)
        self.P, self.H = P, H - np.cross(c, P)
        flown = fly(self.tree, self.P, self.H, joints, times, STEP)
        self.samples = [(R, R @ v, w, q) for R, v, w, q, _ in flown]

    def arm(self, q):
        """Mass, mass centre and inertia about it, in base axes."""
        t = self.tree
        R, p = t.pose(q)
        r = p + np.einsum("bij,bj->bi", R, t.com)
        m = t.mass[1:].sum()
        c = (t.mass[1:, None] * r[1:]).sum(0) / m
        I = np.zeros((3, 3))
        for b in range(1, len(t.mass)):
            d = r[b] - c
            I += R[b] @ t.inertia[b] @ R[b].T + t.mass[b] * (d @ d * np.eye(3) - np.outer(d, d))
        return m, c, I

    def two_steps(self, known, dv_N=np.zeros(3), dw=np.zeros(3)):
        """Mass and tensor of the base with errors of the velocities, one for all samples or one each; stopped joints."""
        first, second = [], []
        arms = self.arms = getattr(self, "arms", None) or [self.arm(q) for *_, q in self.samples]
        dv_N, dw = (np.broadcast_to(e, (len(arms), 3)) for e in (dv_N, dw))
        for (R, v_N, w, _), (m, c, _), ev, ew in zip(self.samples, arms, dv_N, dw):
            v, w = R.T @ (v_N + ev), w + ew
            S = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
            first.append(R @ np.c_[v + np.cross(w, c), S, v])
        first = np.array(first)
        first = first - np.c_[self.P / arms[0][0], np.zeros((3, 4))] if known else first[1:] - first[0]
        A = first.reshape(-1, 5)
        x = np.linalg.lstsq(A[:, :4], -A[:, 4], rcond=None)[0]
        mass, rho = arms[0][0] / x[0], x[1:]
        for (R, _, w, _), (m, c, I), ew in zip(self.samples, arms, dw):
            w = w + ew
            d, mu = c - rho, mass * m / (mass + m)
            g = I @ w + mu * np.cross(d, np.cross(w, d))
            B = np.array([[w[0], 0, 0, w[1], w[2], 0], [0, w[1], 0, w[0], 0, w[2]], [0, 0, w[2], 0, w[0], w[1]]])
            second.append(R @ np.c_[B, g])
        second = np.array(second)
        second = second - np.c_[np.zeros((3, 6)), self.H] if known else second[1:] - second[0]
        B = second.reshape(-1, 7)
        y = np.linalg.lstsq(B[:, :6], -B[:, 6], rcond=None)[0]
        I = np.array([[y[0], y[3], y[4]], [y[3], y[1], y[5]], [y[4], y[5], y[2]]])
        true = self.tree.inertia[0]
        return mass, np.linalg.norm(I - true) / np.linalg.norm(true)

    def noisy(self, known, largest):
        """Median error of the tensor at 3 % of the largest component's maximum, or of each component's own."""
        rng = np.random.default_rng(3)
        sigma = [0.03 * abs(np.array([s[k] for s in self.samples])).max(0) for k in (1, 2)]
        sigma = [np.full(3, s.max()) if largest else s for s in sigma]
        draws = lambda s: s * rng.normal(size=(len(self.samples), 3))
        return float(np.median([self.two_steps(known, draws(sigma[0]), draws(sigma[1]))[1] for _ in range(DRAWS)]))

    def bound(self, sigma_v, sigma_w, known):
        """Cramer-Rao bound of mass and tensor, shares: velocities as functions of unknowns and momentum."""
        t = self.tree
        true = t.inertia[0].copy()
        size = np.linalg.norm(true)
        ij = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
        scale = np.r_[t.mass[0], 1, 1, 1, [size] * 6, [np.linalg.norm(self.H)] * 6]

        def velocities(x):
            old = t.mass[0], t.com[0].copy(), t.inertia[0].copy()
            t.mass[0] += x[0]
            t.com[0] = t.com[0] + x[1:4]
            I = true.copy()
            for k, (i, j) in enumerate(ij):
                I[i, j] = I[j, i] = true[i, j] + x[4 + k]
            t.inertia[0] = I
            out = []
            for R, _, _, q in self.samples:
                v, w = t.base_velocity(R.T @ (self.P + x[10:13]), R.T @ (self.H + x[13:16]), q, np.zeros(6))
                out += [R @ v / sigma_v, w / sigma_w]
            t.mass[0], t.com[0], t.inertia[0] = old
            return np.concatenate(out)

        n = 10 if known else 16
        J = np.zeros((60, n))
        for k in range(n):
            e = np.zeros(16)
            e[k] = 1e-5 * scale[k]
            J[:, k] = (velocities(e) - velocities(-e)) / 2e-5
        C = np.linalg.inv(J.T @ J)
        tensor = sum(C[k, k] * (1 if k < 7 else 2) for k in range(4, 10))
        return [float(np.sqrt(C[0, 0])), float(np.sqrt(tensor))]


def main():
    run = Run()
    examples = [Run(spin=(0, 0, 1)), Run(spin=(0, 1, 5), path=BACK)]
    rows = [(largest, known) for largest in (True, False) for known in (True, False)]
    noise = [{"largest": l, "known": k, "tensor": [e.noisy(k, l) for e in examples]} for l, k in rows]
    out = {"noise": noise, "offset": [], "bias": [], "span": [], "joints": [], "ratio": []}
    for axis in "xz":
        for size in (1.0, 0.001):
            d = size * np.eye(3)["xyz".index(axis)]
            masses = [run.two_steps(known, dv_N=d)[0] for known in (True, False)]
            out["offset"].append({"m_s": size, "axis": axis, "mass_kg": masses})
    for axis in "xyz":
        d = 1e-4 * np.eye(3)["xyz".index(axis)]
        tensors = [run.two_steps(known, dw=d)[1] for known in (True, False)]
        out["bias"].append({"rad_s": 1e-4, "axis": axis, "tensor": tensors})
    # The noise of the project's study: 1 % of the largest components.
    sigma_v = 0.01 * max(abs(v).max() for _, v, _, _ in run.samples)
    sigma_w = 0.01 * max(abs(w).max() for _, _, w, _ in run.samples)
    out["sigma"] = {"v_m_s": sigma_v, "w_rad_s": sigma_w}
    both = lambda r: {"known": r.bound(sigma_v, sigma_w, True), "unknown": r.bound(sigma_v, sigma_w, False)}
    for factor in (1.0, 0.5, 0.25):
        out["span"].append({"factor": factor, **both(Run(factor=factor))})
    for moves in ([0], [1], [0, 1], [0, 1, 2]):
        out["joints"].append({"moves": moves, **both(Run(spin=(0, 1, 5), moves=moves))})
    for ratio in (0.005, 0.02, 0.05, 0.1, 0.2, 0.5):
        out["ratio"].append({"ratio": ratio, **both(Run(ratio=ratio))})
    print(json.dumps(out, indent=1))


main()
