"""The loop of a commissioning on a shipped case: predicted against achieved."""

import runpy

import numpy as np

SCRIPT = "examples/05_design/commissioning.py"
# 99.9 % of a chi-square with six degrees of freedom.
BAND = 22.46


def test_stat_each_step_of_a_commissioning_achieves_what_was_predicted(tmp_path):
    """Three segments: sigmas as predicted, errors within what one trial can tell, and more is known after each."""
    script = runpy.run_path(SCRIPT)
    steps = script["commission"](tmp_path)
    assert len(steps) == 3
    for k, step in enumerate(steps):
        # The first step is predicted for the nominal vehicle, which is 5 to 8 % off.
        allowed = 0.25 if k == 0 else 0.08
        assert np.all(np.abs(step["achieved"] / step["predicted"] - 1.0) < allowed), (k, step)
        assert step["error"] @ np.linalg.solve(step["covariance"], step["error"]) < BAND, (k, step)
        assert k == 0 or np.all(step["achieved"] < steps[k - 1]["achieved"]), (k, step)
    assert len(script["table"](steps).splitlines()) == 8
