"""Momentum of a tree of bodies by definition, for the checks of the papers' studies: NumPy alone.

Frames as in NOTATION.md. Reads the bodies and joints of a model file (`poinsot.model/1`); shares no code with the project.
"""

import tomllib
from pathlib import Path

import numpy as np

DATA = Path(__file__).resolve().parents[2] / "data"


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def turn(axis, angle):
    """Rodrigues' formula."""
    k = skew(axis)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


class Tree:
    """Bodies in the order of the file, the first the base; revolute joints."""

    def __init__(self, path):
        model = tomllib.loads((DATA / path).read_text())
        names = [b["name"] for b in model["body"]]
        self.mass = np.array([b["mass_kg"] for b in model["body"]], float)
        self.com = np.array([b.get("com_m", [0, 0, 0]) for b in model["body"]], float)
        self.inertia = np.zeros((len(names), 3, 3))
        for b, body in enumerate(model["body"]):
            i = body.get("inertia_kg_m2", {})
            get = lambda k: i.get(k, 0.0)
            self.inertia[b] = [
                [get("xx"), get("xy"), get("xz")],
                [get("xy"), get("yy"), get("yz")],
                [get("xz"), get("yz"), get("zz")],
            ]
        self.parent = [-1] * len(names)
        self.origin = np.zeros((len(names), 3))
        self.zero = np.array([np.eye(3)] * len(names))
        self.axis = np.zeros((len(names), 3))
        for j in model["joint"]:
            c = names.index(j["child"])
            self.parent[c] = names.index(j["parent"])
            self.origin[c] = j["origin_m"]
            if "rotation_matrix" in j:
                self.zero[c] = j["rotation_matrix"]
            self.axis[c] = j["axis"]

    def pose(self, q):
        """Rotation and origin of each body in the base."""
        n = len(self.mass)
        R, p = np.zeros((n, 3, 3)), np.zeros((n, 3))
        R[0] = np.eye(3)
        for c in range(1, n):
            a = self.parent[c]
            p[c] = p[a] + R[a] @ self.origin[c]
            R[c] = R[a] @ self.zero[c] @ turn(self.axis[c], q[c - 1])
        return R, p

    def relative(self, q, qd):
        """The same, and the angular velocity and the velocity of the origin relative to the base."""
        R, p = self.pose(q)
        w, v = np.zeros_like(p), np.zeros_like(p)
        for c in range(1, len(self.mass)):
            a = self.parent[c]
            w[c] = w[a] + R[c] @ self.axis[c] * qd[c - 1]
            v[c] = v[a] + np.cross(w[a], p[c] - p[a])
        return R, p, w, v

    def parts(self, q, qd):
        """Mass, first moment and inertia about the base origin; linear and angular momentum relative to the base."""
        R, p, w, v = self.relative(q, qd)
        arm = np.einsum("bij,bj->bi", R, self.com)
        r = p + arm
        I = R @ self.inertia @ R.transpose(0, 2, 1)
        square = (r * r).sum(1)
        spread = self.mass[:, None, None] * (square[:, None, None] * np.eye(3) - r[:, :, None] * r[:, None, :])
        speed = self.mass[:, None] * (v + np.cross(w, arm))
        spin = np.einsum("bij,bj->i", I, w) + np.cross(r, speed).sum(0)
        return self.mass.sum(), self.mass @ r, (I + spread).sum(0), speed.sum(0), spin

    def momentum(self, v_base, w_base, q, qd):
        """Linear momentum and angular momentum about the base origin, in base axes; mass centre of all from it."""
        m, first, I, P, H = self.parts(q, qd)
        return m * v_base + np.cross(w_base, first) + P, np.cross(first, v_base) + I @ w_base + H, first / m

    def base_velocity(self, P, H_com, q, qd):
        """The velocity and rate of the base that have this momentum (about the system's mass centre), base axes."""
        m, first, I, P0, H0 = self.parts(q, qd)
        c = first / m
        central = I - m * (c @ c * np.eye(3) - np.outer(c, c))
        w = np.linalg.solve(central, H_com - (H0 - np.cross(c, P0)))
        return (P - P0 - np.cross(w, first)) / m, w


def fly(tree, P_N, H_N, joints, times, step):
    """Attitudes, velocities of the base (base axes) and rates at times, from R = 1 at time zero with conserved momentum.

    Runge and Kutta's fourth order on the attitude with steps of at most `step`; `joints(t)` gives angles and rates.
    """

    def rate(R, t):
        q, qd = joints(t)
        return tree.base_velocity(R.T @ P_N, R.T @ H_N, q, qd)[1]

    R, t, out = np.eye(3), 0.0, []
    for end in times:
        n = max(1, int(np.ceil((end - t) / step)))
        h = (end - t) / n
        for _ in range(n):
            k1 = R @ skew(rate(R, t))
            k2 = (R + h / 2 * k1) @ skew(rate(R + h / 2 * k1, t + h / 2))
            k3 = (R + h / 2 * k2) @ skew(rate(R + h / 2 * k2, t + h / 2))
            k4 = (R + h * k3) @ skew(rate(R + h * k3, t + h))
            R = R + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            u, _, vt = np.linalg.svd(R)
            R = u @ vt
            t += h
        q, qd = joints(end)
        v, w = tree.base_velocity(R.T @ P_N, R.T @ H_N, q, qd)
        out.append((R, v, w, q, qd))
    return out
