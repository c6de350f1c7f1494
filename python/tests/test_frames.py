"""Data frames of results: the numbers of the documents, one row each."""

import sys

import numpy as np
import pytest

import poinsot as pn

STSAT3 = "data/stsat3/model.toml"
CASE = "data/cases/stsat3_spin.toml"
NUMBERS = ["mass_kg", *(f"com_m.{a}" for a in "xyz"), *(f"inertia_kg_m2.{e}" for e in ("xx", "yy", "zz", "xy", "xz", "yz"))]


@pytest.fixture(scope="module")
def answers() -> list[pn.Answer]:
    return [pn.identify(STSAT3, f"data/stsat3/{run}/telemetry_noisy.csv") for run in ("multiaxis", "paper")]


def _entry(body, number):
    """The number at an address of ``estimate.json``."""
    for key in number.split("."):
        body = body[key]
    return body


@pytest.mark.extra
def test_exact_bodies_hold_the_numbers_of_the_document(answers):
    pd = pytest.importorskip("pandas")
    for answer in answers:
        frame, document = answer.to_dataframe(), answer.to_dict()["bodies"]
        assert frame.columns.tolist() == ["body", "number", "value", "sigma", "unit", "nominal", "source"]
        assert frame.number.tolist() == NUMBERS * len(document)
        for row in frame.itertuples():
            wanted = _entry(document[row.body], row.number)
            assert row.source == (wanted["source"] or "undetermined") and row.nominal == wanted["nominal"]
            for key in ("value", "sigma"):
                assert getattr(row, key) == wanted[key] or (wanted[key] is None and np.isnan(getattr(row, key)))
        pd.testing.assert_frame_equal(answer.bodies["spacecraft"].to_dataframe(), frame)
    assert (frame.source == "undetermined").any()
    assert (frame.value.isna() == (frame.source == "undetermined")).all()
    assert dict(zip(frame.number.str.split(".").str[0], frame.unit)) == {"mass_kg": "kg", "com_m": "m", "inertia_kg_m2": "kg m2"}


@pytest.mark.extra
def test_exact_vehicles_of_several_bodies_have_all_of_them():
    pytest.importorskip("pandas")
    answer = pn.identify("data/xu2017/model.toml", "data/xu2017/C1/telemetry_noisy.parquet", method="linear")
    frame = answer.to_dataframe()
    assert frame.body.tolist() == [name for name in answer.bodies for _ in NUMBERS]


@pytest.mark.extra
def test_exact_residuals_are_those_of_the_answer(answers):
    pd = pytest.importorskip("pandas")
    for residuals in answers[0].predictions:
        frame = residuals.to_dataframe()
        assert len(frame) == residuals.time_s.size and set(frame.sensor) == {residuals.sensor}
        assert (frame.filter(like="residual_").to_numpy() == residuals.residual).all()
        for kind in ("measured", "predicted"):
            columns = [f"{kind}_{name}" for name in residuals.components]
            assert (frame[columns].to_numpy() == getattr(residuals, kind)).all()
    both = pd.concat(answer.residuals("gyro").to_dataframe() for answer in answers)
    assert both.segment.nunique() == 2


@pytest.mark.extra
def test_exact_campaigns_have_a_row_for_each_number_method_and_point():
    pytest.importorskip("pandas")
    swept = pn.sweep(CASE, {"noise": [1, 2], "gyro.noise": [1]}, trials=2, methods=["auto", "linear"])
    frame = swept.to_dataframe()
    rows = iter(frame.to_dict("records"))
    for cell in swept["cells"]:
        for method in cell["methods"]:
            for name, number in method["numbers"].items():
                row = next(rows)
                assert (row["experiment"], row["method"], row["number"]) == (cell["experiment"], method["method"], name)
                assert {address: row[address] for address in cell["at"]} == cell["at"]
                assert row["trials"] == number["trials"] and row["bound"] == number["bound"]
                for key in ("bias", "rmse", "rmse_over_bound", "coverage_answered", "coverage_all"):
                    band = number[key]
                    assert [row[key], row[f"{key}_low"], row[f"{key}_high"]] == pytest.approx([band["value"], band["low"], band["high"]], abs=0.0)
    assert next(rows, None) is None and len(frame) == 24
    assert frame["bound"].dtype == float and repr(swept).startswith("<poinsot.CampaignResult ")


def test_unit_without_pandas_the_error_says_what_to_install(answers, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    for result in (answers[0], answers[0].bodies["spacecraft"], answers[0].residuals("gyro"), pn.sweep(CASE, {"noise": [1]}, trials=1)):
        with pytest.raises(pn.InputError, match=r"E0001 pandas: .*pip install 'poinsot\[frames\]'"):
            result.to_dataframe()
