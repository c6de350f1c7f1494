#!/usr/bin/env python3
"""Figures of the Python package, each printed as name,value,unit.

usage: POINSOT_PYTHON=python scripts/bench-python [--wheel FILE.whl] [--calls N]
       POINSOT_PYTHON=python scripts/bench-python --dask    (a campaign by one and two workers of Dask, nothing else)

Needs the package `poinsot` with NumPy; compares with Pinocchio where the wheel `pin` is installed, and with the command
where POINSOT names the program. The NumPy regressor is that of benches/peers/numpy_least_squares.py, for the arm of Xu
et al. (2017).
"""

import argparse
import gc
import os
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
ROOT = Path(__file__).resolve().parents[2]

import numpy as np

STATES = 100_000
REPEATS = 5
# A fit takes as long as thousands of the other calls.
FIT_EVERY = 1000
# Of the memory during the calls.
SAMPLES = 100
# Of the campaign by workers, in shards of some seconds: with few shards one worker would wait for the other's last one.
TRIALS, PER_SHARD = 400, 25


def show(name: str, value: float, unit: str) -> None:
    print(f"{name},{value:.4g},{unit}", flush=True)


def best(call, repeats: int = REPEATS, clock=time.perf_counter) -> float:
    """Least time of some calls, s: what others do on the machine only adds."""
    times = []
    for _ in range(repeats):
        began = clock()
        call()
        times.append(clock() - began)
    return min(times)


def import_time() -> None:
    """Time of an import in a new process, NumPy's own taken off."""
    code = "import numpy, time; t = time.perf_counter(); import poinsot; print(time.perf_counter() - t)"
    runs = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout) for _ in range(REPEATS)]
    show("import_beyond_numpy", min(runs), "s")


def identify() -> None:
    """A fit from arrays against the command on the same file, whole processes' work but for their start."""
    import poinsot as pn

    model, file = ROOT / "data/stsat3/model.toml", ROOT / "data/stsat3/multiaxis/telemetry_noisy.csv"
    vehicle, record = pn.Model.read(model), pn.Telemetry.read(file)
    arrays = pn.Telemetry.from_arrays(time_s=record["omega_x"][0], columns={n: record[n][1] for n in record})
    program = os.environ.get("POINSOT")
    words = [program, "identify", "--model", str(model), "--telemetry", str(file), "--quiet"] if program else None
    ours, theirs = [], []
    for _ in range(REPEATS):
        ours.append(best(lambda: pn.identify(vehicle, arrays), 1))
        if words:
            theirs.append(best(lambda: subprocess.run(words, check=True), 1))
    show("identify_arrays", min(ours), "s")
    if theirs:
        show("identify_command", min(theirs), "s")
        show("identify_arrays_over_command", min(ours) / min(theirs), "1")


def regressor() -> None:
    """The momentum regressor of the Xu arm over many states: ours, vectorised NumPy, a loop over Pinocchio."""
    import numpy_least_squares as peer

    import poinsot as pn

    vehicle = pn.Model.read(ROOT / "data/xu2017/model.toml")
    rng = np.random.default_rng(1)
    q, rates = rng.uniform(-2, 2, (STATES, 6)), rng.uniform(-0.5, 0.5, (STATES, 6))
    v, w = rng.uniform(-0.1, 0.1, (STATES, 3)), rng.uniform(-0.1, 0.1, (STATES, 3))
    V = np.concatenate([v, w], axis=1)
    # The peer's frames: a quarter turn about x, then the joint; the model adds angles at zero.
    turns = [np.array(j.get("rotation_matrix", np.eye(3)), float) for j in vehicle.to_dict()["joint"]]
    peer.ROLL = [round(np.arctan2(-t[1, 2], t[2, 2]) / (np.pi / 2)) for t in turns]
    angles = q + [np.arctan2(-t[0, 1], t[0, 0]) for t in turns]
    ours = pn.dynamics.momentum_regressor(vehicle, q, rates, V)
    show("regressor_difference_to_numpy", np.abs(ours - peer.regressor(angles, rates, v, w)).max(), "SI")
    del ours
    memory = np.empty((STATES, 70, 6))
    kinds = {
        "poinsot": (lambda: pn.dynamics.momentum_regressor(vehicle, q, rates, V), REPEATS),
        "poinsot_memory_reused": (lambda: pn.dynamics.momentum_regressor(vehicle, q, rates, V, out=memory), REPEATS),
        "numpy": (lambda: peer.regressor(angles, rates, v, w), 3),
    }
    loop = pinocchio_loop(vehicle, q, rates, V)
    if loop:
        kinds["pinocchio_loop"] = (loop, 1)
    for clock, kind in ((time.perf_counter, "wall"), (time.process_time, "processor")):
        times = {name: best(call, repeats, clock) for name, (call, repeats) in kinds.items()}
        for name, seconds in times.items():
            show(f"regressor_{name}_{kind}", seconds, "s")
        for name in kinds:
            if not name.startswith("poinsot"):
                show(f"regressor_{name}_over_poinsot_{kind}", times[name] / times["poinsot"], "1")
                show(f"regressor_{name}_over_poinsot_memory_reused_{kind}", times[name] / times["poinsot_memory_reused"], "1")


def pinocchio_loop(vehicle, q, rates, V):
    """The same matrix from Pinocchio, one state a call.

    The joint torque regressor at rest, with the velocity in place of the acceleration and without gravity, is that of the
    generalised momentum; its first six rows are the momentum regressor.
    """
    try:
        import pinocchio as pin
    except ImportError:
        return None
    import poinsot as pn

    model = arm_of(pin, vehicle)
    data = model.createData()
    configuration, velocity, rest = np.zeros(model.nq), np.zeros(model.nv), np.zeros(model.nv)
    configuration[6] = 1.0
    out = np.empty((STATES, 6, 70))

    def run(states: int = STATES) -> None:
        for k in range(states):
            configuration[7:] = q[k]
            velocity[:6], velocity[6:] = V[k], rates[k]
            out[k] = pin.computeJointTorqueRegressor(model, data, configuration, rest, velocity)[:6]

    run(50)
    ours = pn.dynamics.momentum_regressor(vehicle, q[:50], rates[:50], V[:50])
    show("regressor_difference_to_pinocchio", np.abs(ours - out[:50]).max(), "SI")
    return run


def arm_of(pin, vehicle):
    """The tree in Pinocchio, built from the tables of the model."""
    values = vehicle.to_dict()
    model = pin.Model()
    model.gravity.setZero()
    of = {values["body"][0]["name"]: model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")}
    for body in values["body"]:
        if body["name"] in of:
            model.appendBodyToJoint(1, pin.Inertia.Random(), pin.SE3.Identity())
    for joint in values["joint"]:
        turn = np.array(joint.get("rotation_matrix", np.eye(3)), float)
        place = pin.SE3(turn, np.array(joint["origin_m"], float))
        index = model.addJoint(of[joint["parent"]], pin.JointModelRevoluteUnaligned(np.array(joint["axis"], float)), place, joint["name"])
        model.appendBodyToJoint(index, pin.Inertia.Random(), pin.SE3.Identity())
        of[joint["child"]] = index
    return model


def calls(count: int) -> None:
    """Memory after many calls of every kind, errors too."""
    import poinsot as pn

    vehicle = pn.Model.read(ROOT / "data/xu2017/model.toml")
    q, V = np.zeros((4, 6)), np.zeros((4, 6))
    time_s = np.arange(10.0)
    satellite = pn.Model.read(ROOT / "data/stsat3/model.toml")
    slews = pn.Telemetry.read(ROOT / "data/stsat3/multiaxis/telemetry_noisy.csv")
    problem = pn.Problem(satellite, slews)

    def resident() -> float:
        gc.collect()
        return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 2**20

    def one(k: int) -> None:
        pn.dynamics.momentum_regressor(vehicle, q, q, V)
        pn.dynamics.forward_dynamics(vehicle, q, q, V, q)
        record = pn.Telemetry.from_arrays(time_s=time_s, omega_rad_s=np.zeros((10, 3)))
        if k % 100 == 0:
            record.to_dict()
            vehicle.to_dict()
            try:
                pn.Model.from_text("schema = 1")
            except pn.PoinsotError:
                pass
        if k % FIT_EVERY == 0:
            pn.identify(satellite, slews).report()
            problem.evaluate(problem.x0)

    for k in range(count // 10):
        one(k)
    # Memory of a process goes up and down with the arenas of its threads: the least of a tenth of the samples counts.
    samples = []
    for k in range(count):
        one(k)
        if k % (count // SAMPLES) == 0:
            samples.append(resident())
    show("calls", count, "1")
    show("memory_growth", min(samples[-SAMPLES // 10 :]) - min(samples[: SAMPLES // 10]), "MiB")


def workers() -> None:
    """A campaign by one process, by one worker and by two workers of Dask over TCP on loopback."""
    import tempfile

    from distributed import Client, LocalCluster

    import poinsot as pn

    text = (ROOT / "data/campaigns/tug_thrusters.toml").read_text()
    text = text.replace("trials = 10000", f"trials = {TRIALS}\ntrials_per_shard = {PER_SHARD}").replace("../cases", str(ROOT / "data/cases"))
    plan = Path(tempfile.mkdtemp()) / "plan.toml"
    plan.write_text(text)

    def alone() -> None:
        code = f"import poinsot as pn; pn.campaign({str(plan)!r})"
        subprocess.run([sys.executable, "-c", code], check=True, env=dict(os.environ, RAYON_NUM_THREADS="1"))

    times = [best(alone, 1)]
    for count in (1, 2):
        cluster = LocalCluster(n_workers=count, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None)
        with cluster, Client(cluster) as client, tempfile.TemporaryDirectory() as out:
            client.wait_for_workers(count)
            times.append(best(lambda: pn.campaign(plan, out=out, client=client), 1))
    for name, seconds in zip(("process", "one_worker", "two_workers"), times):
        show(f"campaign_{name}", seconds, "s")
    show("campaign_two_workers_over_one_worker", times[1] / times[2], "1")
    show("campaign_two_workers_over_process", times[0] / times[2], "1")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--wheel", type=Path)
    parser.add_argument("--calls", type=int, default=100_000)
    parser.add_argument("--dask", action="store_true")
    asked = parser.parse_args()
    if asked.dask:
        return workers()
    if asked.wheel:
        show("wheel", asked.wheel.stat().st_size / 1e6, "MB")
    import_time()
    identify()
    regressor()
    calls(asked.calls)


if __name__ == "__main__":
    main()
