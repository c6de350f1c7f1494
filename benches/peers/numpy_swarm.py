"""One iteration of a particle swarm on the cost (37) of Xu et al. (2017), plain NumPy, vectorised over particles
and samples: 50 particles, 600 samples, one thread. Prints name,value,unit."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import time

import numpy as np

particles, samples = 50, 600
rng = np.random.default_rng(2017)
w, dw, acc, force, torque = (rng.normal(size=(3, samples)) for _ in range(5))
sensor = np.array([0.2, 0.1, -0.15])


def cross(a, b):
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def spin(a):
    """I a for a unit of each element xx, yy, zz, xy, xz, yz."""
    o = 0 * a[0]
    return np.stack([np.stack(c) for c in [
        (a[0], o, o), (o, a[1], o), (o, o, a[2]), (a[1], a[0], o), (a[2], o, a[0]), (o, a[2], a[1])]])


# (36) with the unknowns taken out: two matrix products an evaluation.
lw = spin(w)
gi = spin(dw) + np.stack([cross(w, lw[k]) for k in range(6)])
unit = np.eye(3)[:, :, None] * np.ones(samples)
gc = np.stack([cross(unit[k], force) for k in range(3)])
moved = lambda d: cross(dw, d) + cross(w, cross(w, d))
h0 = acc - moved(sensor[:, None] * np.ones(samples))
hc = np.stack([moved(unit[k]) for k in range(3)])


def cost(x):
    g = np.tensordot(x[:, 1:7], gi, 1) + np.tensordot(x[:, 7:], gc, 1) - torque
    h = x[:, 0][:, None, None] * (h0 + np.tensordot(x[:, 7:], hc, 1)) - force
    return (np.sqrt((g * g).sum(1)) + np.sqrt((h * h).sum(1))).mean(-1)


low = np.array([0, 0, 0, 0, -50, -50, -50, -1, -1, -1.0])
high = np.array([1000, 200, 200, 200, 50, 50, 50, 1, 1, 1.0])
x = low + (high - low) * rng.random((particles, 10))
v = np.zeros_like(x)
own, own_cost = x.copy(), cost(x)
objective = iteration = float("inf")
for _ in range(300):
    start = time.perf_counter()
    lead = own[own_cost.argmin()]
    v = 0.7 * v + 1.49445 * (rng.random(x.shape) * (own - x) + rng.random(x.shape) * (lead - x))
    x = np.clip(x + v, low, high)
    before = time.perf_counter()
    c = cost(x)
    objective = min(objective, time.perf_counter() - before)
    better = c < own_cost
    own[better], own_cost[better] = x[better], c[better]
    iteration = min(iteration, time.perf_counter() - start)
print(f"numpy_swarm_objective_50x600,{objective * 1e6:.1f},us")
print(f"numpy_swarm_iteration_50x600,{iteration * 1e6:.1f},us")
