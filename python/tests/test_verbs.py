"""Every other verb against the command."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest

import poinsot as pn

STSAT3 = "data/stsat3/model.toml"
MULTIAXIS = "data/stsat3/multiaxis/telemetry_noisy.csv"
CASE = "data/cases/stsat3_spin.toml"


def content(result):
    """Values of a result or of its text, without the checksum of the file."""
    result = json.loads(result) if isinstance(result, str) else result
    if isinstance(result, list):
        return [content(part) for part in result]
    return {key: value for key, value in dict(result).items() if key != "sha256"}


def test_exact_check(command):
    document = pn.check(STSAT3)
    printed = json.loads(command("check", STSAT3, "--json").stdout)
    assert printed.pop("schema") == "poinsot.description/1"
    assert dict(document) == printed
    assert str(document).strip() == command("check", STSAT3).stdout.strip()


def test_exact_inspect(command):
    document = pn.inspect(MULTIAXIS)
    assert dict(document) == json.loads(command("inspect", MULTIAXIS, "--json").stdout)


def test_exact_simulate(command, tmp_path):
    """In memory, into a folder, and by the command: the same numbers."""
    simulation = pn.simulate(CASE)
    written = pn.simulate(CASE, out=tmp_path / "a")
    assert command("simulate", CASE, "--out", tmp_path / "b", "--quiet").returncode == 0
    name = "telemetry.csv" if (tmp_path / "b" / "telemetry.csv").exists() else "telemetry.parquet"
    assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    truth = content((tmp_path / "b" / "truth.json").read_text())
    named = {name: hashlib.sha256((tmp_path / "b" / name).read_bytes()).hexdigest()}
    assert content(written.truth) == truth == {**content(simulation.truth), "files": named}
    of_file = pn.Telemetry.read(tmp_path / "b" / name)
    assert set(simulation.telemetry) == set(of_file)
    for channel in of_file:
        for ours, theirs in zip(simulation.telemetry[channel], of_file[channel]):
            assert np.array_equal(ours, theirs), channel


def test_exact_predict(command):
    document = pn.predict(CASE)
    done = command("predict", CASE, "--json")
    assert content(document) == content(done.stdout) and document.exit_code == done.returncode


def test_exact_predict_of_several_cases(command, tmp_path):
    """One entry a case, and the files of the command."""
    cases = [CASE, "data/cases/stsat3_kim2010.toml"]
    document = pn.predict(cases, durations=True, out=tmp_path / "a")
    done = command("predict", *cases, "--durations", "--out", tmp_path / "b", "--json")
    assert content([document[case] for case in cases]) == content(done.stdout) and document.exit_code == done.returncode
    for case in cases:
        name = Path(case).stem + "/prediction.json"
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    with pytest.raises(pn.InputError, match="same file name"):
        pn.predict([CASE, CASE], out=tmp_path / "c")
    with pytest.raises(pn.InputError, match="no case"):
        pn.predict([])


def test_exact_validate(command, tmp_path):
    pn.identify(STSAT3, MULTIAXIS).write(tmp_path)
    document = pn.validate(MULTIAXIS, model=STSAT3, estimate=tmp_path)
    done = command("validate", "--model", STSAT3, "--estimate", tmp_path, "--against", MULTIAXIS, "--json")
    assert content(document) == content(done.stdout) and document.exit_code == done.returncode


def test_exact_compare(command, tmp_path):
    """Answers in memory and in folders compare alike."""
    answers = [pn.identify(STSAT3, MULTIAXIS, time_s=span) for span in ((0, 60), (60, 120))]
    folders = [tmp_path / "a", tmp_path / "b"]
    for answer, folder in zip(answers, folders):
        answer.write(folder)
    done = command("compare", *folders, "--json")
    wanted = content(done.stdout)
    assert content(pn.compare(folders)) == wanted
    document = pn.compare(answers)
    assert document["verdict"] == wanted["verdict"] and document.exit_code == done.returncode
    for name, number in wanted["numbers"].items():
        # The last digit of a number read from a file may be another.
        assert document["numbers"][name]["values"] == pytest.approx(number["values"], rel=1e-14)


def test_exact_methods_and_units(command):
    assert pn.methods() == json.loads(command("methods", "--json").stdout)["methods"]
    assert pn.units() == json.loads(command("units", "--json").stdout)["units"]


URDF = """<robot name="tug"><link name="bus"><inertial><mass value="10"/>
<inertia ixx="1" iyy="2" izz="2.5" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def test_exact_export(command, tmp_path):
    """What is known in a URDF file, identified and written back."""
    (tmp_path / "tug.urdf").write_text(URDF)
    values = pn.Model.from_urdf(tmp_path / "tug.urdf").to_dict()
    assert values["body"][0]["mass_kg"] == 10.0
    spacecraft = URDF.replace('"bus"', '"spacecraft"').replace('"10"', '"150"')
    (tmp_path / "spacecraft.urdf").write_text(spacecraft)
    answer = pn.identify(STSAT3, MULTIAXIS)
    text = answer.export("urdf", tmp_path / "new.urdf", onto=tmp_path / "spacecraft.urdf")
    answer.write(tmp_path / "out")
    done = command("export", tmp_path / "out", "--to", "urdf", "--onto", tmp_path / "spacecraft.urdf")
    assert done.stdout == text == (tmp_path / "new.urdf").read_text()
    with pytest.raises(pn.InputError):
        answer.export("step", onto=tmp_path / "spacecraft.urdf")


def test_exact_models_read_write_and_change(tmp_path):
    vehicle = pn.Model.read("data/xu2017/model.toml")
    vehicle.write(tmp_path / "again.toml")
    again = pn.Model.read(tmp_path / "again.toml")
    of_dict = pn.Model.from_dict(vehicle.to_dict())
    assert again.to_dict() == of_dict.to_dict() == vehicle.to_dict()
    assert (again.parameters == vehicle.parameters).all()
    assert vehicle.parameters.shape == (len(vehicle.bodies), 10)
    values = vehicle.to_dict()
    # Numbers of NumPy are numbers.
    values["body"][0]["com_m"] = np.array([0.1, 0.0, 0.0])
    values["body"][0]["mass_kg"] = np.float32(300.0)
    assert pn.Model.from_dict(values).parameters[0, :2].tolist() == [300.0, 30.0]


def test_exact_inertia_of_other_programs():
    pin, mujoco = pytest.importorskip("pinocchio"), pytest.importorskip("mujoco")
    tensor = np.array([[2.398, -0.069, 0.013], [-0.069, 2.678, 0.051], [0.013, 0.051, 1.405]])
    ours = pn.Inertia(30.0, [-0.27, 0.0, 0.43], tensor)
    theirs = pin.Inertia(30.0, ours.com_m, tensor)
    assert np.abs(theirs.toDynamicParameters() - ours.to_dynamic_parameters()).max() < 1e-14
    assert pn.Inertia.from_pinocchio(theirs) == ours
    assert np.linalg.eigvalsh(ours.pseudo_inertia())[0] > 0.0
    assert np.abs(ours.pseudo_inertia() - pin.PseudoInertia.FromInertia(theirs).toMatrix()).max() < 1e-13
    full = " ".join(map(str, tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]))
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><worldbody><body name='b'><freejoint/><inertial pos='-0.27 0 0.43' mass='30' fullinertia='{full}'/></body></worldbody></mujoco>"
    )
    assert np.abs(pn.Inertia.from_mujoco(model, "b").inertia_kg_m2 - tensor).max() < 1e-12
    assert not pn.Inertia(1.0, [0, 0, 0], np.diag([1.0, 1.0, 3.0])).is_physical


def same(document, command, *words):
    """A document and the command with these words: the same values and exit code."""
    done = command(*words, "--json")
    assert content(document) == content(done.stdout) and document.exit_code == done.returncode


BOX_DESIGN = """
schema = "poinsot.case/1"
model = "MODEL"
duration_s = 40.0
[initial]
momentum_zero = true
[output]
rate_hz = 4
[[want]]
number = "spacecraft.inertia_kg_m2"
relative = 1e-3
[[limits.wheel]]
speed_rad_s = 150.0
torque_N_m = 0.05
[design]
starts = 1
evaluations = 60
[[design.wheel]]
nodes = 5
"""


def test_exact_design(command, tmp_path):
    case = tmp_path / "design.toml"
    case.write_text(BOX_DESIGN.replace("MODEL", str(Path(STSAT3).resolve())))
    folder = tmp_path / "out"
    document = pn.design(case, out=folder)
    assert content(document) == content((folder / "design.json").read_text())
    assert "commands.csv" in document["files"]
    for name, digest in document["files"].items():
        assert hashlib.sha256((folder / name).read_bytes()).hexdigest() == digest
    same(pn.design(case), command, "design", case)
    fronted = pn.design(case, front="duration")
    same(fronted, command, "design", case, "--front", "duration")
    assert fronted["front"] and not document.get("front")


def test_exact_campaign_and_sweep(command, tmp_path):
    """In memory and with files: the statistics of the command, times of computing apart."""

    def untimed(value):
        if isinstance(value, dict):
            return {k: untimed(v) for k, v in value.items() if "second" not in k and "time" not in k and k != "cpu_s"}
        return [untimed(v) for v in value] if isinstance(value, list) else value

    plan = "data/campaigns/ma_traj1.toml"
    document = pn.campaign(plan, trials=4)
    done = command("campaign", plan, "--trials", "4", "--out", tmp_path / "out", "--json")
    assert untimed(content(document)) == untimed(content(done.stdout)) and document.exit_code == done.returncode
    case = "data/cases/stsat3_spin.toml"
    document = pn.sweep(case, {"noise": [1, 2]}, trials=3)
    done = command("sweep", case, "--vary", "noise=1,2", "--trials", "3", "--json")
    assert untimed(content(document)) == untimed(content(done.stdout)) and document.exit_code == done.returncode
    assert len(document["cells"]) == 2


def test_paper_study(command):
    same(pn.study("kim2010", "table2"), command, "study", "kim2010", "table2")


def test_errors_of_searches():
    with pytest.raises(pn.InputError, match="it needs a folder"):
        pn.campaign("data/campaigns/ma_traj1.toml", until=0.01)
    with pytest.raises(pn.InputError, match="there is no such paper"):
        pn.study("kim2011", "table2")
    with pytest.raises(pn.InputError, match="it has no .design."):
        pn.design(CASE)
