"""The verb identify: bits of the command, arrays and data frames, what an answer holds."""

import json
from pathlib import Path

import numpy as np
import pytest

import poinsot as pn

STSAT3 = "data/stsat3/model.toml"
MULTIAXIS = "data/stsat3/multiaxis/telemetry_noisy.csv"
ONE_SLEW = "data/stsat3/paper/telemetry_noisy.csv"

SHIPPED = sorted(Path("data").glob("*/*/telemetry*")) or sorted(
    (Path(__file__).resolve().parents[2] / "data").glob("*/*/telemetry*")
)
QUICK = ("stsat3/multiaxis/telemetry_noisy.csv", "stsat3/paper/telemetry_noisy.csv")


def _case(path: Path) -> object:
    name = "/".join(path.parts[-3:])
    return pytest.param(path, id=name, marks=() if name in QUICK else pytest.mark.slow)


@pytest.fixture(scope="module")
def answer() -> pn.Answer:
    return pn.identify(STSAT3, MULTIAXIS)


def _table(path: Path) -> dict[str, np.ndarray]:
    if path.suffix == ".parquet":
        import pyarrow.parquet

        table = pyarrow.parquet.read_table(path)
        return {name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names}
    import csv

    with path.open() as file:
        names = next(csv.reader(file))
    values = np.genfromtxt(path, delimiter=",", skip_header=1)
    return {name: values[:, k] for k, name in enumerate(names)}


@pytest.mark.parametrize("path", [_case(p) for p in SHIPPED])
def test_exact_bits_of_the_command(path, command, tmp_path):
    """Files and arrays give the bytes that the command writes; arrays differ in the name of the input alone."""
    model = path.parents[1] / "model.toml"
    done = command("identify", "--model", model, "--telemetry", path, "--out", tmp_path, "--quiet")
    try:
        of_file = pn.identify(model, path)
    except pn.PoinsotError as error:
        assert done.returncode in (2, 3)
        assert error.code in done.stderr
        return
    written = (tmp_path / "estimate.json").read_text()
    assert of_file.to_json() == written
    assert of_file.exit_code == done.returncode
    of_bytes = pn.identify(model, pn.Telemetry.from_bytes(path.read_bytes(), name=str(path)))
    assert of_bytes.to_json() == written
    record = pn.Telemetry.from_arrays(time_s=_table(path)["time_s"], columns=_table(path) | {"time_s": _table(path)["time_s"]})
    of_arrays, wanted = pn.identify(model, record).to_dict(), json.loads(written)
    # Records are named by their files.
    wanted = json.loads(json.dumps(wanted).replace(str(path), "<arrays>"))
    for document in (of_arrays, wanted):
        del document["sha256"]
        for entry in document["inputs"]:
            del entry["sha256"]
    of_arrays["repairs"] = [r for r in of_arrays["repairs"] if "checksums" not in r]
    wanted["repairs"] = [r for r in wanted["repairs"] if "checksums" not in r]
    assert of_arrays == wanted


def test_exact_answer_holds_the_document(answer):
    document = answer.to_dict()
    body, entry = answer.bodies["spacecraft"], document["bodies"]["spacecraft"]
    assert answer.status == document["status"] == "converged"
    assert answer.acceptable and answer.evidence == ()
    assert 0.0 <= answer.sensitivities["wheel motion between samples"] < 1.0
    tensor = entry["inertia_kg_m2"]
    assert body.inertia_kg_m2[0, 1] == body.inertia_kg_m2[1, 0] == tensor["xy"]["value"]
    assert body.inertia_sigma_kg_m2[2, 2] == tensor["zz"]["sigma"]
    assert body.source["mass_kg"] == "known" and body.source["inertia_kg_m2.xx"] == "data"
    assert answer.covariance.matrix.shape == (len(answer.covariance.names),) * 2
    k = answer.covariance.names.index("spacecraft.inertia_kg_m2.xx")
    assert answer.covariance.sigma[k] > 0.0
    residuals = answer.residuals("gyro")
    assert residuals.residual.shape == (residuals.time_s.size, 3)
    assert np.abs(residuals.residual).max() < 1e-2


def test_exact_undetermined_is_nan_and_named():
    """One slew determines three of six: no single entry has a number."""
    answer = pn.identify(STSAT3, ONE_SLEW)
    body = answer.bodies["spacecraft"]
    assert answer.rank == (3, 6) and answer.status == "partial" and not answer.acceptable
    for element, (i, j) in {"xx": (0, 0), "xy": (0, 1), "zz": (2, 2)}.items():
        open_entry = body.source[f"inertia_kg_m2.{element}"] is None
        assert open_entry == bool(np.isnan(body.inertia_kg_m2[i, j])) == bool(np.isnan(body.inertia_sigma_kg_m2[i, j]))
    assert np.isnan(body.inertia_kg_m2).any() and not body.determined
    assert len(answer.undetermined) == 3
    assert all(d.reason and d.remedy and d.coefficients for d in answer.undetermined)


def test_exact_data_frames_are_arrays():
    """pandas, polars and an Arrow table give one answer."""
    pd, pl, pa = pytest.importorskip("pandas"), pytest.importorskip("polars"), pytest.importorskip("pyarrow")
    frame = pd.read_csv(MULTIAXIS)

    class Stream:
        """Nothing but an Arrow stream."""

        def __init__(self, table):
            self._table = table

        def __arrow_c_stream__(self, requested_schema=None):
            return self._table.__arrow_c_stream__(requested_schema)

    plain = pn.identify(STSAT3, MULTIAXIS).bodies["spacecraft"].inertia_kg_m2
    for given in (frame, pl.from_pandas(frame), pa.Table.from_pandas(frame), Stream(pa.Table.from_pandas(frame))):
        found = pn.identify(STSAT3, given).bodies["spacecraft"].inertia_kg_m2
        assert (found == plain).all(), type(given)


def test_exact_dates_are_times():
    """Dates of pandas and polars count as seconds do."""
    pd, pl = pytest.importorskip("pandas"), pytest.importorskip("polars")
    frame = pd.read_csv(MULTIAXIS)
    dated = frame.assign(time_s=pd.Timestamp("2026-03-14T18:19:00") + pd.to_timedelta(frame["time_s"], unit="s"))
    plain = pn.identify(STSAT3, frame).bodies["spacecraft"].inertia_kg_m2
    for given in (dated, pl.from_pandas(dated)):
        found = pn.identify(STSAT3, given).bodies["spacecraft"]
        assert np.abs(found.inertia_kg_m2 - plain).max() < 1e-3 * found.inertia_sigma_kg_m2.min()


def test_exact_parts_with_time_bases_of_their_own():
    """Gyro at one rate and wheels at another are one segment."""
    record = pn.Telemetry.read(MULTIAXIS)
    gyro = pn.Telemetry.from_arrays(
        time_s=record["omega_x"][0], omega_rad_s=np.column_stack([record[f"omega_{a}"][1] for a in "xyz"])
    )
    rest = pn.Telemetry.from_arrays(
        time_s=record["q_x"][0],
        q_xyzw=np.column_stack([record[f"q_{a}"][1] for a in "xyzw"]),
        wheel_rad_s={f"wheel{k}": record[f"wheel{k}_rad_s"][1] for k in (1, 2, 3)},
        name="<slow>",
    )
    joined = pn.Telemetry.join(gyro, rest)
    assert joined.sources == ("<arrays>", "<slow>")
    whole = pn.identify(STSAT3, record).bodies["spacecraft"].inertia_kg_m2
    parts = pn.identify(STSAT3, joined).bodies["spacecraft"].inertia_kg_m2
    assert (whole == parts).all()


def test_exact_report_and_files(answer, tmp_path, command):
    page = answer.report(tmp_path / "report.html")
    assert page.startswith("<!") and (tmp_path / "report.html").read_text() == page
    assert "iframe" in answer._repr_html_()
    written = answer.write(tmp_path / "out", report=True)
    assert any(p.endswith("estimate.json") for p in written)
    assert (tmp_path / "out" / "estimate.json").read_text() == answer.to_json()
    # The command takes the folder as its own.
    assert command("report", tmp_path / "out").returncode == 0
    assert "I_xx" in str(answer) and "converged" in repr(answer)


def test_exact_progress_is_told():
    told = []
    pn.identify(STSAT3, [MULTIAXIS], progress=lambda *step: told.append(step))
    assert told and all(isinstance(s, str) and d <= max(t, d) for s, d, t in told)


def test_exact_an_exception_of_the_callback_ends_the_call():
    def refuse(*_):
        raise KeyError("stop")

    with pytest.raises(KeyError):
        pn.identify(STSAT3, [MULTIAXIS], progress=refuse)


def test_exact_options_are_those_of_the_command(command, tmp_path):
    done = command(
        "identify", "--model", STSAT3, "--telemetry", MULTIAXIS, "--out", tmp_path, "--quiet",
        "--method", "linear", "--every", "2", "--time-s", "10,100", "--relative-accuracy", "0.5",
    )  # fmt: skip
    answer = pn.identify(STSAT3, MULTIAXIS, method="linear", every=2, time_s=(10, 100), relative_accuracy=0.5)
    assert answer.to_json() == (tmp_path / "estimate.json").read_text()
    assert answer.exit_code == done.returncode
