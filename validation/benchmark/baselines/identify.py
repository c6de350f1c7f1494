"""Poinsot and its implementations of the three papers' methods, by `poinsot identify`."""

import json
import subprocess
import tempfile

from common import Answer, asked

# Entry to method and variant.
METHODS = {
    "poinsot": ("auto", None),
    "poinsot_linear": ("linear", None),
    "kim2010_batch": ("kim2010", "batch"),
    "kim2010_suggested": ("kim2010", "suggested"),
    "ma2008": ("ma2008", None),
    "xu2017_linear": ("xu2017", "linear"),
}


def estimate(program, entry, folder):
    """Answers of one record, all refused where the method returns an error; and whether it took the record."""
    method, variant = METHODS[entry]
    names, *_ = asked(folder)
    # Joint torques are not for Poinsot.
    files = ",".join(sorted(p.name for p in folder.glob("*.csv") if p.stem != "torque"))
    with tempfile.TemporaryDirectory() as out:
        run = [program, "identify", "--model", "model.toml", "--telemetry", files, "--out", out, "--method", method, "--quiet"]
        done = subprocess.run(run + (["--variant", variant] if variant else []), cwd=folder, capture_output=True, text=True, timeout=300)
        # 0: determined, 1: not all; all else is an error of the question.
        if done.returncode not in (0, 1):
            return [Answer(folder.parent.name, int(folder.name), n) for n in names]
        with open(f"{out}/estimate.json") as file:
            bodies = json.load(file)["bodies"]
    answers = []
    for name in names:
        found = bodies
        for key in name.split("."):
            found = (found or {}).get(key)
        value, sigma = (found or {}).get("value"), (found or {}).get("sigma")
        told = (value, sigma) if value is not None and sigma else (None, None)
        answers.append(Answer(folder.parent.name, int(folder.name), name, *told))
    return answers
