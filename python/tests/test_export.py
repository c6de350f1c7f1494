"""Exports read back by the programs that they are for."""

import importlib
import json
import os
import runpy
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

CASE = "data/cases/stsat3_spin.toml"
BODY = "spacecraft"

SDF = """<?xml version="1.0"?>
<sdf version="1.9">
  <!-- by hand -->
  <model name="sat">
    <link name="spacecraft">
      <inertial>
        <pose>0.1 0 0 0 0 1.2</pose>
        <mass>1</mass>
        <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>
      </inertial>
      <visual name="hull"><geometry><box><size>1 1 1</size></box></geometry></visual>
    </link>
  </model>
</sdf>
"""
MJCF = """<mujoco model="sat">
  <!-- by hand -->
  <worldbody>
    <body name="spacecraft">
      <freejoint/>
      <inertial pos="0 0 0" quat="0.7 0.7 0 0" mass="1" diaginertia="1 1 1"/>
      <geom size="0.5" />
      <body name="boom"><joint/><geom size="0.1"/></body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def answer(command, tmp_path_factory):
    """A folder with telemetry of known date and the answer of `identify`."""
    folder = tmp_path_factory.mktemp("export")
    assert command("simulate", CASE, "--out", folder / "sim").returncode == 0
    model = Path("data/stsat3/model.toml").read_text()
    assert "[telemetry]" not in model
    (folder / "model.toml").write_text(model + '\n[telemetry]\ntime = { column = "time_s", epoch = "2026-03-14T18:19:00Z" }\n')
    done = command(
        "identify", "--model", folder / "model.toml", "--telemetry", folder / "sim" / "telemetry.csv", "--out", folder
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def expected(answer):
    body = json.loads((answer / "estimate.json").read_text())["bodies"][BODY]
    i = {name: number["value"] for name, number in body["inertia_kg_m2"].items()}
    tensor = [[i["xx"], i["xy"], i["xz"]], [i["xy"], i["yy"], i["yz"]], [i["xz"], i["yz"], i["zz"]]]
    return SimpleNamespace(
        mass=body["mass_kg"]["value"], com=np.array([body["com_m"][axis]["value"] for axis in "xyz"]), inertia=np.array(tensor)
    )


def consumer(name):
    """The module of a program that reads exports; skips without it, fails where POINSOT_CONSUMERS says that it is there."""
    return importlib.import_module(name) if os.environ.get("POINSOT_CONSUMERS") else pytest.importorskip(name)


def exported(command, answer, to, onto=None):
    out = answer / f"exported.{to}"
    arguments = ["--onto", onto] if onto else []
    done = command("export", answer, "--to", to, *arguments, "-o", out)
    assert done.returncode == 0, done.stderr
    return out


def test_xval_mujoco_reads_mjcf(command, answer, expected):
    mujoco = consumer("mujoco")
    (answer / "sat.xml").write_text(MJCF)
    out = exported(command, answer, "mjcf", answer / "sat.xml")
    assert "<!-- by hand -->" in out.read_text() and 'name="boom"' in out.read_text()
    model = mujoco.MjModel.from_xml_path(str(out))
    k = model.body(BODY).id
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[k])
    turn = turn.reshape(3, 3)
    assert model.body_mass[k] == pytest.approx(expected.mass, rel=1e-12)
    assert np.allclose(model.body_ipos[k], expected.com, atol=1e-12)
    assert np.allclose(turn @ np.diag(model.body_inertia[k]) @ turn.T, expected.inertia, rtol=1e-9, atol=1e-9)


def test_xval_mujoco_would_replace_the_inertias(command, answer):
    """The setting that makes MuJoCo ignore them is an error."""
    (answer / "geom.xml").write_text(MJCF.replace("<worldbody>", '<compiler inertiafromgeom="true"/><worldbody>', 1))
    done = command("export", answer, "--to", "mjcf", "--onto", answer / "geom.xml")
    assert done.returncode == 2 and "inertiafromgeom" in done.stderr and "auto" in done.stderr


def test_xval_drake_reads_sdf(command, answer, expected):
    consumer("pydrake")
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    (answer / "sat.sdf").write_text(SDF)
    out = exported(command, answer, "sdf", answer / "sat.sdf")
    assert "<!-- by hand -->" in out.read_text()
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(out))
    plant.Finalize()
    body = plant.GetBodyByName(BODY)
    spatial = body.default_spatial_inertia()
    central = spatial.Shift(spatial.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
    assert spatial.get_mass() == pytest.approx(expected.mass, rel=1e-12)
    assert np.allclose(spatial.get_com(), expected.com, atol=1e-12)
    assert np.allclose(central, expected.inertia, rtol=1e-12, atol=1e-12)


def test_xval_basilisk_takes_the_hub(command, answer, expected):
    consumer("Basilisk")
    from Basilisk.simulation import spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros

    out = exported(command, answer, "basilisk")
    shutil.copy(out, answer / "identified.py")
    craft = spacecraft.Spacecraft()
    runpy.run_path(str(answer / "identified.py"))["set_hub"](craft)
    craft.hub.omega_BN_BInit = [[0.01], [-0.02], [0.03]]
    sim = SimulationBaseClass.SimBaseClass()
    sim.CreateNewProcess("p").addTask(sim.CreateNewTask("t", macros.sec2nano(0.1)))
    sim.AddModelToTask("t", craft)
    log = craft.scStateOutMsg.recorder()
    sim.AddModelToTask("t", log)
    sim.InitializeSimulation()
    sim.ConfigureStopTime(macros.sec2nano(100.0))
    sim.ExecuteSimulation()
    assert craft.hub.mHub == expected.mass
    # The hub turns by Euler's equation of the exported tensor: kinetic energy of rotation stays.
    w = np.array(log.omega_BN_B)
    energy = np.einsum("ti,ij,tj->t", w, expected.inertia, w)
    assert np.ptp(w[:, 0]) > 1e-4 and np.allclose(energy, energy[0], rtol=1e-9)


def test_exact_model_keeps_every_other_line(command, answer, expected):
    import tomllib

    onto = answer / "model.toml"
    out = exported(command, answer, "model", onto)
    new = tomllib.loads(out.read_text())
    body = new["body"][0]
    assert body["mass_kg"] == expected.mass and np.array_equal(body["com_m"], expected.com)
    assert body["inertia_kg_m2"]["xy"] == expected.inertia[0, 1]
    changed = [a for a, b in zip(onto.read_text().splitlines(), out.read_text().splitlines()) if a != b]
    assert all(line.split(" =")[0] in ("mass_kg", "com_m", "inertia_kg_m2") for line in changed)
    assert command("check", out).returncode == 0


def test_exact_table_and_onboard(command, answer, expected):
    import csv

    rows = list(csv.DictReader(exported(command, answer, "csv").open()))
    found = {row["quantity"]: row for row in rows if row["body"] == BODY}
    assert float(found["inertia_kg_m2.xx"]["value"]) == expected.inertia[0, 0] and found["mass_kg"]["source"] == "known"
    table = json.loads(exported(command, answer, "onboard").read_text())
    assert np.array_equal(table["bodies"][BODY]["inertia_kg_m2"], expected.inertia)
    covariance = np.array(table["covariance"])
    assert covariance.shape == (len(table["covariance_names"]),) * 2 and np.all(np.linalg.eigvalsh(covariance) > 0)
