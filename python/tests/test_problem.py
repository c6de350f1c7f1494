"""A problem for an estimator of one's own."""

import pathlib

import numpy as np
import pytest

import poinsot as pn

STSAT3 = "data/stsat3/model.toml"
MULTIAXIS = "data/stsat3/multiaxis/telemetry_noisy.csv"


@pytest.fixture(scope="module")
def problem() -> pn.Problem:
    return pn.Problem(STSAT3, MULTIAXIS)


@pytest.fixture(scope="module")
def minimum(problem) -> np.ndarray:
    """Where an optimizer that we did not write ends."""
    optimize = pytest.importorskip("scipy.optimize")
    start = problem.x0
    found = optimize.least_squares(
        problem.residual, start, jac=problem.jacobian, x_scale="jac", xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    return found.x


def test_exact_slopes_are_those_of_the_residual(problem, minimum):
    jacobian = problem.jacobian(minimum)
    sigma = np.sqrt(np.diag(problem.evaluate(minimum).covariance))
    for k, name in enumerate(problem.names):
        step = np.zeros_like(minimum)
        step[k] = sigma[k]
        slope = (problem.residual(minimum + step) - problem.residual(minimum - step)) / (2 * sigma[k])
        assert np.abs(slope - jacobian[:, k]).max() < 1e-3 * np.abs(slope).max(), name


def test_exact_information_and_operator(problem):
    pytest.importorskip("scipy")
    here = problem.evaluate(problem.x0)
    assert np.allclose(here.information, here.jacobian.T @ here.jacobian)
    assert np.allclose(here.covariance @ here.information, np.eye(len(problem.names)), atol=1e-4)
    x = np.linspace(-1.0, 1.0, len(problem.names))
    assert np.allclose(here.operator() @ x, here.jacobian @ x)
    assert {s["sensor"] for s in here.sensors} == {"gyro", "attitude"}
    gyro = here.sensors[0]
    rows = here.residual[gyro["first_row"] : gyro["first_row"] + gyro["white"].size]
    assert np.allclose(rows.reshape(-1, 3), gyro["white"], atol=1e-9)


def test_xval_least_squares_of_scipy_finds_the_same_minimum(problem, minimum):
    """SciPy ends where maximum likelihood does."""
    body = pn.identify(STSAT3, MULTIAXIS).bodies["spacecraft"]
    values = dict(zip(problem.names, minimum))
    sigma = dict(zip(problem.names, np.sqrt(np.diag(problem.evaluate(minimum).covariance))))
    for element, (i, j) in {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}.items():
        name = next(n for n in problem.names if n.endswith(f"I_{element}") or n.endswith(f"_{element}"))
        # The mass centre is known to be at the origin: about it and about the mass centre are one.
        assert abs(values[name] - body.inertia_kg_m2[i, j]) < 0.05 * sigma[name], element


def test_exact_the_gate_is_that_of_identify(tmp_path):
    record = pn.Telemetry.read(MULTIAXIS)
    with pytest.raises(pn.InputError) as refused:
        pn.Problem(STSAT3, [record, record])
    with pytest.raises(pn.InputError) as same:
        pn.identify(STSAT3, [record, record])
    assert str(refused.value) == str(same.value)


def test_exact_wrong_lengths_are_refused(problem):
    with pytest.raises(pn.InputError, match="E0411"):
        problem.evaluate(problem.x0[:-1])
    with pytest.raises(pn.InputError):
        problem.evaluate(np.zeros((2, 2)))


def test_regress_a_measured_joint_has_no_spring(tmp_path):
    """A joint that a column measures moves as it says: its spring is no unknown, here as in identify."""
    model = pathlib.Path("data/cases/hinged_panel_truth.toml").read_text()
    model = model.replace("damping_N_m_s_per_rad = 0.02", "damping_N_m_s_per_rad = 0.02, estimate = true")
    model = model.replace("yz = 0.59 }", "yz = 0.59 }\nestimate = true", 1)
    case = pathlib.Path("data/cases/hinged_panel.toml").read_text()
    case = case.replace("sensors_only = true", "").replace("hinged_panel_truth.toml", "model.toml")
    (tmp_path / "model.toml").write_text(model)
    (tmp_path / "case.toml").write_text(case)
    whole = pn.simulate(tmp_path / "case.toml").telemetry
    time_s, _ = whole["omega_x"]
    columns = {name: whole[name][1] for name in whole if not name.startswith("hinge")}
    free = pn.Telemetry.from_arrays(time_s=time_s, columns=columns)
    springs, measured = (pn.Problem(tmp_path / "model.toml", record) for record in (free, whole))
    # Stiffness, damping and rest, and where the hinge starts and how fast.
    assert [sum("hinge" in name for name in problem.names) for problem in (springs, measured)] == [5, 0]
