"""Reads records as any entrant can: model.toml, CSV files and numbers.csv of a folder; nothing of the truth."""

import csv
import pathlib
import sys
import tomllib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "families"))
import motion
from families import ELEMENTS

SENSORS = {"gyro": "gyro", "attitude": "st", "position": "pos", "velocity": "vel"}


class Answer:
    """One line of an entry; a value of None refuses the number."""

    def __init__(self, vehicle, seed, number, value=None, sigma=None):
        self.vehicle, self.seed, self.number, self.value, self.sigma = vehicle, seed, number, value, sigma

    def row(self):
        return [self.vehicle, self.seed, self.number, *("" if x is None else f"{x:.10g}" for x in (self.value, self.sigma))]


def asked(folder):
    """Names, nominal values and prior sigmas of the numbers of a vehicle."""
    with open(folder.parent / "numbers.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return [r["number"] for r in rows], *(np.array([float(r[key]) for r in rows]) for key in ("nominal", "prior"))


def tensor(elements):
    out = np.zeros((3, 3))
    for e, (i, j) in ELEMENTS.items():
        out[i, j] = out[j, i] = elements[e]
    return out


class Record:
    """A record: `bodies`, `joints`, `wheels` of the model as `motion.Vehicle` takes them (one copy), tables of sensors."""

    def __init__(self, folder):
        self.folder = folder
        self.model = tomllib.loads((folder / "model.toml").read_text())
        self.names, self.nominal, self.prior = asked(folder)
        one = lambda x: np.asarray(x, float)[None]
        index = {b["name"]: k for k, b in enumerate(self.model["body"])}
        self.bodies = [(one(b["mass_kg"]), one(b["com_m"]), one(tensor(b["inertia_kg_m2"]))) for b in self.model["body"]]
        self.joints = [
            (index[j["parent"]], one(j["origin_m"]), motion.matrix(one(j["rotation_xyzw"])), one(j["axis"]))
            for j in self.model.get("joint", [])
        ]
        self.wheels = [(index[w["body"]], one(w["axis"]), one(w["spin_inertia_kg_m2"])) for w in self.model.get("wheel", [])]
        self.thrusters = [(np.array(t["position_m"]), np.array(t["force_direction"])) for t in self.model.get("thruster", [])]
        self.sensors = {s["type"]: s for s in self.model["sensor"]}
        self.tables = {p.stem: np.loadtxt(p, delimiter=",", skiprows=1, ndmin=2) for p in folder.glob("*.csv")}
        for file in ("st", "gyro", "rw", "enc", "rate", "pos", "vel"):
            self.tables.setdefault(file, None)
        self.unknown = {index[b["name"]]: b["estimate"] is True for b in self.model["body"] if b.get("estimate")}
        main = next(self.tables[f] for f in ("gyro", "rw", "st") if self.tables[f] is not None)
        self.times_s = main[:, 0]

    def inputs(self):
        """Joint angles, rates and wheel speeds at the samples of the gyro, and their variances."""
        count = len(self.times_s)
        blank = np.zeros((count, 0))
        at = lambda file: blank if self.tables[file] is None else self.tables[file][:, 1:]
        angles, rates, speeds = at("enc"), at("rate"), at("rw")
        kinds = (("joint_position", "rad", angles), ("joint_rate", "rad_s", rates), ("wheel_speed", "rad_s", speeds))
        noise = [np.full(x.shape[1], self.variance(kind, unit)) for kind, unit, x in kinds]
        return angles, rates, speeds, np.concatenate(noise)

    def variance(self, kind, unit):
        sensor = self.sensors.get(kind, {})
        return sensor.get(f"noise_{unit}", 0.0) ** 2 + sensor.get(f"quantisation_{unit}", 0.0) ** 2 / 12

    def mean_wrench(self, begin, end):
        """Torque about the base's origin and force in B, means over intervals [n]: forces are held between switches."""
        if not self.thrusters:
            return np.zeros((len(begin), 6))
        table = self.tables["thr"]
        widths = np.diff(np.append(table[:, 0], 1e9))[:, None]
        sums = np.concatenate([np.zeros((1, len(self.thrusters))), np.cumsum(table[:, 1:] * widths, axis=0)])
        starts = np.append(table[:, 0], table[-1, 0] + 1e9)
        impulse = lambda t: np.stack([np.interp(t, starts, sums[:, j]) for j in range(sums.shape[1])], axis=1)
        force = (impulse(end) - impulse(begin)) / (end - begin)[:, None]
        columns = np.stack([np.concatenate([np.cross(at, along), along]) for at, along in self.thrusters])
        return force @ columns

    def body_values(self, values):
        """Bodies with other values of the asked numbers, [S, numbers]."""
        bodies = [tuple(np.repeat(x, len(values), axis=0) for x in b) for b in self.bodies]
        at = 0
        for b, whole in self.unknown.items():
            mass, centre, _ = bodies[b]
            if whole:
                mass, centre, at = values[:, at], values[:, at + 1 : at + 4], at + 4
            about = np.zeros((len(values), 3, 3))
            for k, (i, j) in enumerate(ELEMENTS.values()):
                about[:, i, j] = about[:, j, i] = values[:, at + k]
            bodies[b], at = (mass, centre, about), at + 6
        return bodies

    def answers(self, values=None, sigma=None, given=None):
        """Of all asked numbers; `given`: which are not refused."""
        vehicle, seed = self.folder.parent.name, int(self.folder.name)
        if values is None:
            return [Answer(vehicle, seed, n) for n in self.names]
        given = np.ones(len(values), bool) if given is None else given
        return [Answer(vehicle, seed, n, *((v, s) if g else ())) for n, v, s, g in zip(self.names, values, sigma, given)]
