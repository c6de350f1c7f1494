"""Robots as `poinsot check` and as Pinocchio read them: mass, mass centre, principal moments of the whole.

    python3 benches/peers/urdf.py --poinsot target/release/poinsot FOLDER      (pip install pin numpy)
"""

import argparse
import glob
import json
import os
import subprocess
import sys

import numpy as np
import pinocchio as pin


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--poinsot", required=True)
    parser.add_argument("folder")
    options = parser.parse_args()
    files = sorted(
        f
        for f in glob.glob(os.path.join(options.folder, "**", "*"), recursive=True)
        if f.lower().endswith(".urdf")
    )
    refused = alone = compared = 0
    worst = 0.0
    for file in files:
        done = subprocess.run(
            [options.poinsot, "check", "--json", file], capture_output=True, text=True, check=False
        )
        if done.returncode:
            refused += 1
            continue
        try:
            model = pin.buildModelFromUrdf(file, pin.JointModelFreeFlyer())
        except (RuntimeError, ValueError):
            alone += 1
            continue
        ours = json.loads(done.stdout)
        data = model.createData()
        pin.ccrba(model, data, pin.neutral(model), np.zeros(model.nv))
        mass = pin.computeTotalMass(model)
        centre = pin.centerOfMass(model, data, pin.neutral(model))
        moments = np.linalg.eigvalsh(data.Ig.inertia)
        worst = max(
            worst,
            abs(ours["mass_kg"] - mass) / mass,
            np.abs(ours["system"]["com_m"] - centre).max() / (1e-3 + np.abs(centre).max()),
            np.abs(np.sort(ours["system"]["principal_kg_m2"]) - moments).max() / moments[-1],
        )
        compared += 1
    print(
        f"{len(files)} files: {refused} refused, {alone} that only Poinsot reads, {compared} compared;"
        f" largest relative difference {worst:.1e}"
    )
    sys.exit(0 if worst < 1e-9 else 1)


if __name__ == "__main__":
    main()
