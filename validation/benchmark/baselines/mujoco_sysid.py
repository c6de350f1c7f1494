"""MuJoCo's identification toolbox on the arms whose joint torques are read. Runs in its own environment: mujoco[sysid]==3.8.1 (3.17 and
4.0 raise an error for a full inertia).

    mujoco_sysid.py FOLDER ...       answers of each record as CSV lines on standard output

The toolbox rolls the arm out from a start that it must be given (at rest, as it was; place and attitude of the first samples) under the
read torques, and fits mass properties to all sensors, each weighted by its declared noise, every 0.2 s. Sigma by its own rule: scatter of
the residuals times the inverse of the normal matrix. A number whose sigma exceeds half of its prior is refused."""

import contextlib
import csv
import io
import logging
import pathlib
import sys

import numpy as np

from common import ELEMENTS, Record

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
VEHICLES = ["mujoco_target", "mujoco_base"]
TORQUE_STEP_S = 0.02


def readings(record):
    """At the samples of the tracker, in the order of the sensors of the MJCF, with one sigma of each column."""
    at = record.tables["st"][:, 0]
    keep = np.isin(np.round(record.times_s, 6), np.round(at, 6))
    st, gyro = record.tables["st"][:, 1:], record.tables["gyro"][keep, 1:]
    # The toolbox has no unknown of the gyro: at rest at the start, the first second shows the bias.
    gyro = gyro - record.tables["gyro"][:1, 1:]
    angles, rates = record.tables["enc"][keep, 1:], record.tables["rate"][keep, 1:]
    place, velocity = record.tables["pos"][:, 1:], record.tables["vel"][:, 1:]
    columns = [angles, rates, gyro, st[:, [3, 0, 1, 2]], place, velocity]
    kinds = [("joint_position", "rad"), ("joint_rate", "rad_s"), ("gyro", "rad_s"), ("attitude", "rad"), ("position", "m"), ("velocity", "m_s")]
    sigmas = [np.full(c.shape[1], record.variance(*kind) ** 0.5) for c, kind in zip(columns, kinds)]
    # A small turn moves the four numbers of an attitude by half of it.
    sigmas[3] = sigmas[3] / 2
    return at, np.concatenate(columns, axis=1), np.concatenate(sigmas)


def physical(pi):
    mass, centre = pi[0], pi[1:4] / pi[0]
    s = np.cross(np.eye(3), centre)
    about = np.reshape(pi[4:], (3, 3)) + mass * s @ s
    return np.array([mass, *centre, *(about[ij] for ij in ELEMENTS.values())])


def estimate(folder):
    import mujoco
    import vehicles
    from mujoco import sysid

    record = Record(folder)
    at, read, sigma = readings(record)
    body = f"b{next(iter(record.unknown))}"
    spec = mujoco.MjSpec.from_string(vehicles.engines.mjcf(record.bodies, record.joints, TORQUE_STEP_S))
    model = spec.compile()
    unknown = sysid.ParameterDict()
    limits = {"stretch_bound_mult": np.array([0.02, 50]), "shear_bound_off": np.array([-3, 3])}
    unknown.add(sysid.body_inertia_param(spec, model, body, inertia_type=sysid.InertiaType.Pseudo, **limits))
    pose = model.qpos0.copy()
    pose[:3], pose[3:7], pose[7:] = record.tables["pos"][0, 1:], record.tables["st"][0, [4, 1, 2, 3]], record.tables["enc"][0, 1:]
    torque = record.tables["torque"]
    sequences = sysid.ModelSequences(
        "arm",
        spec,
        "record",
        sysid.create_initial_state(model, pose, np.zeros(model.nv)),
        sysid.TimeSeries.from_control_names(torque[:, 0], torque[:, 1:], model),
        # What it predicts after a step are the sensors of the state before that step.
        sysid.TimeSeries.from_names(at + TORQUE_STEP_S, read, model),
    )

    def weighted(params, predicted, measured, model, every, state=None):
        there = (measured.times >= predicted.times[0]) & (measured.times <= predicted.times[-1])
        shown = predicted.resample(measured.times[there])
        off = (measured.data[there] - shown.data) / sigma
        return off, shown, sysid.TimeSeries(measured.times[there], measured.data[there], shown.signal_mapping)

    residual = sysid.build_residual_fn(models_sequences=[sequences], modify_residual=weighted)
    # It prints its iterations.
    with contextlib.redirect_stdout(io.StringIO()):
        found, result = sysid.optimize(
            initial_params=unknown, residual_fn=residual, optimizer="scipy_parallel_fd", verbose=False, x_scale="jac"
        )
    theta = np.asarray(found[f"{body}_inertia"].value)
    rest, *_ = residual(result.x, found)
    with np.errstate(all="ignore"):
        covariance, _ = sysid.calculate_intervals([np.concatenate(rest)], np.asarray(result.jac))
    pi = lambda t: physical(np.asarray(sysid.model_modifier.pi_from_theta(t)))
    slopes = np.stack([(pi(theta + d) - pi(theta - d)) / 2e-6 for d in 1e-6 * np.eye(10)], axis=1)
    values, sigmas = pi(theta), np.sqrt(np.diag(slopes @ covariance @ slopes.T))
    good = np.isfinite(sigmas) & (sigmas > 0) & (sigmas < 0.5 * record.prior)
    return record.answers(values, sigmas, good)


def main():
    logging.disable(logging.CRITICAL)
    out = csv.writer(sys.stdout)
    for folder in sys.argv[1:]:
        for answer in estimate(pathlib.Path(folder)):
            out.writerow(answer.row())
        sys.stdout.flush()


if __name__ == "__main__":
    main()
