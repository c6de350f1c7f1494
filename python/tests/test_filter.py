"""The on-board filter on rows as they arrive."""

import json
import math

import numpy as np
import pytest

import poinsot as pn

STSAT3 = "data/stsat3/model.toml"
MULTIAXIS = "data/stsat3/multiaxis/telemetry_noisy.csv"


@pytest.fixture(scope="module")
def columns() -> dict[str, np.ndarray]:
    """The record as NumPy reads it."""
    table = np.genfromtxt(MULTIAXIS, delimiter=",", names=True, comments="#")
    return {name: table[name] for name in table.dtype.names}


def _same(one: pn.FilterAnswer, other: pn.FilterAnswer) -> None:
    assert (one.health, one.accepted, one.gated) == (other.health, other.accepted, other.gated)
    assert one.values.keys() == other.values.keys()
    for of_one, of_other in ((one.values, other.values), (one.sigma, other.sigma)):
        assert np.allclose(list(of_one.values()), list(of_other.values()), rtol=1e-9, atol=0.0, equal_nan=True)


def test_xval_follow_gives_what_the_command_prints(command, columns):
    done = command("follow", STSAT3, MULTIAXIS, "--line-s", 5)
    printed = [json.loads(line) for line in done.stdout.splitlines()]
    answers = list(pn.follow(STSAT3, columns, every_s=5.0))
    assert len(answers) == len(printed) > 5
    for answer, line in zip(answers, printed):
        assert math.isclose(answer.time_s, line["time_s"], abs_tol=1e-9)
        assert answer.health == line["health"]
        for address, number in line["numbers"].items():
            assert math.isclose(answer.sigma[address], number["sigma"], rel_tol=1e-9)
            assert math.isnan(answer.values[address]) if number["value"] is None else math.isclose(answer.values[address], number["value"], rel_tol=1e-9)
    assert math.isnan(next(iter(answers[0].values.values()))) and answers[-1].health == "determined"


def test_exact_rows_one_by_one_are_the_rows_at_once(columns):
    """However the rows are cut, the filter gets the same samples."""
    at_once, one_by_one = pn.Filter(STSAT3), pn.Filter(STSAT3)
    count = 400
    whole = at_once.push({name: values[:count] for name, values in columns.items()})
    for k in range(count):
        last = one_by_one.push({name: values[k] for name, values in columns.items()})
        assert (last is None) == (k == 0)
    _same(last, whole)
    assert math.isclose(whole.time_s, columns["time_s"][count - 1])


def test_xval_a_data_frame_gives_what_its_columns_give(columns):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(columns).head(400)
    of_frame = list(pn.follow(STSAT3, frame, every_s=10.0))
    of_columns = list(pn.follow(STSAT3, {name: values[:400] for name, values in columns.items()}, every_s=10.0))
    assert len(of_frame) == len(of_columns)
    _same(of_frame[-1], of_columns[-1])


def test_unit_an_answer_long_after_the_last_row_is_stale(columns):
    on_board = pn.Filter(STSAT3)
    assert on_board.answer() is None and "no samples" in repr(on_board)
    now = on_board.push({name: values[:400] for name, values in columns.items()})
    assert on_board.answer(now.time_s).health == now.health != "stale"
    assert on_board.answer(now.time_s + 3600.0).health == "stale"
    assert any("prior" in line for line in on_board.assumed)


def test_unit_rows_that_cannot_be_read_are_refused(columns):
    on_board = pn.Filter(STSAT3)
    first = {name: values[:400] for name, values in columns.items()}
    before = on_board.push(first)
    fewer = {name: values[400:] for name, values in list(columns.items())[:-1]}
    with pytest.raises(pn.InputError, match="other columns"):
        on_board.push(fewer)
    with pytest.raises(pn.InputError, match="several lengths"):
        on_board.push(first | {"time_s": columns["time_s"][:3]})
    with pytest.raises(pn.InputError, match="no data frame"):
        on_board.push(3.0)
    # The filter is as before, and goes on.
    _same(on_board.answer(), before)
    after = on_board.push({name: values[400:500] for name, values in columns.items()})
    assert after.time_s > before.time_s


def test_unit_a_vehicle_that_the_filter_does_not_follow_is_refused():
    with pytest.raises(pn.InputError, match="no joints that springs move"):
        pn.Filter("data/cases/slosh_truth.toml")
    # At the call, not at the first answer.
    with pytest.raises(pn.InputError, match="several are unknown"):
        pn.follow("data/xu2017/model.toml", {})
