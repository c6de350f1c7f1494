"""Input that breaks programs: a clear error or the right answer."""

import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import poinsot as pn

STSAT3 = "data/stsat3/model.toml"
MULTIAXIS = "data/stsat3/multiaxis/telemetry_noisy.csv"


@pytest.fixture(scope="module")
def arrays():
    record = pn.Telemetry.read(MULTIAXIS)
    return {
        "time_s": record["omega_x"][0],
        "omega_rad_s": np.column_stack([record[f"omega_{a}"][1] for a in "xyz"]),
        "q_xyzw": np.column_stack([record[f"q_{a}"][1] for a in "xyzw"]),
        "wheel_rad_s": {f"wheel{k}": record[f"wheel{k}_rad_s"][1] for k in (1, 2, 3)},
    }


@pytest.fixture(scope="module")
def plain(arrays):
    return pn.identify(STSAT3, pn.Telemetry.from_arrays(**arrays)).bodies["spacecraft"].inertia_kg_m2


def _inertia(**arrays):
    return pn.identify(STSAT3, pn.Telemetry.from_arrays(**arrays)).bodies["spacecraft"].inertia_kg_m2


def test_exact_any_layout_gives_the_same_bits(arrays, plain):
    rates = arrays["omega_rad_s"]
    wide = np.zeros((rates.shape[0], 7))
    wide[:, 1:6:2] = rates
    layouts = [np.asfortranarray(rates), wide[:, 1:6:2], rates[::-1][::-1], rates.tolist(), rates.astype(">f8"), np.ma.array(rates)]
    for layout in layouts:
        assert (_inertia(**arrays | {"omega_rad_s": layout}) == plain).all()
    rates.flags.writeable = False
    assert (_inertia(**arrays) == plain).all()


def test_exact_missing_samples_are_no_samples(arrays, plain):
    """NaN, masked and None are a sample that is not there."""
    rates = arrays["omega_rad_s"].copy()
    rates[100] = np.nan
    with_nan = _inertia(**arrays | {"omega_rad_s": rates})
    masked = np.ma.masked_invalid(rates)
    assert (_inertia(**arrays | {"omega_rad_s": masked}) == with_nan).all()
    objects = rates.astype(object)
    objects[100] = None
    assert (_inertia(**arrays | {"omega_rad_s": objects}) == with_nan).all()
    assert 0.0 < np.abs(with_nan - plain).max() < 1e-3


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"omega_rad_s": np.zeros((3, 4800))}, "one row per time"),
        ({"omega_rad_s": np.zeros(4800)}, "shape"),
        ({"time_s": np.zeros((2, 2))}, "dimension"),
        ({"time_s": []}, "shape"),
        ({"time_s": "soon"}, "number"),
        ({"time_s": None}, "number"),
        ({"omega_rad_s": np.zeros((4800, 3), complex)}, "real"),
        ({"omega_rad_s": [["a", "b", "c"]] * 4800}, "real"),
        ({"omega_rad_s": [[1, 2], [3]]}, "array"),
        ({"wheel_rad_s": {"wheel1": np.zeros(7)}}, "values"),
        ({"wheel_rad_s": {"wheel1": 3.0}}, "dimension"),
    ],
)
def test_exact_wrong_arrays_are_refused(arrays, change, word):
    with pytest.raises(pn.InputError, match=word) as refused:
        _inertia(**arrays | change)
    assert refused.value.code.startswith("E0") and refused.value.advice


@pytest.mark.parametrize(("row", "value"), [(5, np.inf), (5, np.nan), (5, -1.0), (0, 1e300), (4, 0.25), (4800, 0.0)])
def test_exact_times_that_are_none_are_refused_at_once(arrays, row, value):
    """Where the record is made, with the index and the value."""
    times = arrays["time_s"].copy()
    times[row] = value
    with pytest.raises(pn.InputError) as refused:
        pn.Telemetry.from_arrays(**arrays | {"time_s": times})
    # The first time that does not come after the one before it.
    at = row + 1 if value == 1e300 else row
    assert refused.value.code == "E0208" and refused.value.place == f"time_s[{at}]"
    assert refused.value.advice and repr(float(times[at])) in str(refused.value)


def test_exact_dates_that_are_none_are_refused_at_once():
    times = np.datetime64("2026-03-14T18:19:00", "ms") + np.arange(4) * np.timedelta64(100, "ms")
    for change, place in ((np.datetime64("NaT"), "time_s[2]"), (times[1], "time_s[2]")):
        wrong = times.copy()
        wrong[2] = change
        with pytest.raises(pn.InputError) as refused:
            pn.Telemetry.from_arrays(time_s=wrong, omega_rad_s=np.zeros((4, 3)))
        assert refused.value.code == "E0208" and refused.value.place == place
    assert "2026-03-14T18:19:00.1" in str(refused.value)


def test_exact_frames_without_times_or_rows_are_refused_at_once():
    """Rows of one time stay: they are joined, as those of a file."""

    class Column(list):
        def to_numpy(self):
            return np.array(self, dtype=np.float64)

    class Frame(dict):
        @property
        def columns(self):
            return list(self)

    def of(times):
        return pn.Telemetry.from_frame(Frame(time_s=Column(times), omega_x=Column(np.ones(len(times)))))

    for times, place in (([0.0, np.nan, 0.2], "time_s[1]"), ([], "time_s")):
        with pytest.raises(pn.InputError) as refused:
            of(times)
        assert refused.value.place == place and refused.value.advice
    assert of([0.0, 0.1, 0.1])["omega_x"][0].tolist() == [0.0, 0.1]


def test_exact_wheel_speeds_as_one_array(arrays, plain):
    """Names beside one array, and the other name of the argument, give the bits of a dictionary."""
    speeds = arrays["wheel_rad_s"]
    rest = {name: values for name, values in arrays.items() if name != "wheel_rad_s"}
    table = np.column_stack(list(speeds.values()))
    for given in (
        {"wheel_rad_s": table, "wheels": list(speeds)},
        {"wheel_speeds": table.tolist(), "wheels": tuple(speeds)},
        {"wheel_speeds": speeds},
    ):
        assert (_inertia(**rest | given) == plain).all()
    one = pn.Telemetry.from_arrays(time_s=arrays["time_s"], wheel_speeds=speeds["wheel1"], wheels="wheel1")
    assert (one["wheel1_rad_s"][1] == speeds["wheel1"]).all()


@pytest.mark.parametrize(
    ("change", "place", "word"),
    [
        ({"wheel_rad_s": np.zeros((4801, 3))}, "wheel_rad_s", "wheels="),
        ({"wheel_rad_s": [0.0, 1.0]}, "wheel_rad_s", "has no names"),
        ({"wheel_rad_s": None, "wheel_speeds": np.zeros((4801, 3))}, "wheel_speeds", "wheels="),
        ({"wheel_rad_s": np.zeros((4801, 3)), "wheels": ["a", "b"]}, "wheel_rad_s", r"expected \(4801, 2\)"),
        ({"wheel_rad_s": np.zeros((3, 4801)), "wheels": ["a", "b", "c"]}, "wheel_rad_s", r"expected \(4801, 3\)"),
        ({"wheel_rad_s": np.zeros((4801, 2)), "wheels": ["a", "a"]}, "wheels", "repeat"),
        ({"wheels": ["wheel1"]}, "wheels", "no array"),
        ({"wheel_speeds": {}}, "wheel_speeds", "another name"),
        ({"joint_rad": np.zeros((4801, 2))}, "joint_rad", "name of the joint"),
        ({"thruster_N": np.zeros(4801)}, "thruster_N", "name of the thruster"),
        ({"columns": np.zeros((4801, 2))}, "columns", "has no names"),
        ({"time_s": []}, "time_s", "holds no time"),
        ({"wheel_rad_s": {"wheel1": []}}, "wheel_rad_s['wheel1']", "0 values for 4801 times"),
    ],
)
def test_exact_arrays_that_are_guessed_wrong_are_refused_by_their_argument(arrays, change, place, word):
    only_time = change.get("time_s") is not None
    given = change | {"omega_rad_s": np.zeros((0, 3))} if only_time else arrays | change
    with pytest.raises(pn.InputError, match=word) as refused:
        pn.Telemetry.from_arrays(**given)
    assert refused.value.place == place and refused.value.advice and isinstance(refused.value, ValueError)


@pytest.mark.parametrize("arguments", [(), ({"time_s": [0.0]},), (STSAT3,)])
def test_exact_a_call_of_a_class_names_its_constructors(arguments):
    for of, ways in ((pn.Telemetry, ("read", "from_frame", "from_arrays", "from_bytes", "join")), (pn.Model, ("read", "from_urdf", "from_mjcf", "from_text", "from_dict"))):
        with pytest.raises(TypeError) as refused:
            of(*arguments)
        assert all(f"{of.__name__}.{way}(" in str(refused.value) for way in ways)
    with pytest.raises(TypeError, match="from_arrays"):
        pn.Telemetry(time_s=[0.0], omega_rad_s=[[0.0, 0.0, 0.0]])


def test_exact_infinite_values_are_refused_with_their_row(arrays):
    rates = arrays["omega_rad_s"].copy()
    rates[41, 1] = np.inf
    with pytest.raises(pn.InputError) as refused:
        _inertia(**arrays | {"omega_rad_s": rates})
    assert refused.value.place == "<arrays> row 42 column 'omega_y'"


def test_exact_empty_and_short_records(arrays):
    for rows in (0, 1):
        few = {k: v[:rows] if not isinstance(v, dict) else {n: w[:rows] for n, w in v.items()} for k, v in arrays.items()}
        with pytest.raises(pn.InputError):
            _inertia(**few)
    for nothing in ([], (), {}):
        with pytest.raises(pn.InputError):
            pn.identify(STSAT3, nothing)


def test_exact_ten_million_rows_are_refused_at_once():
    """More than the memory allowed for a fit: an error that names a step, in seconds."""
    n = 10_000_000
    time_s = np.arange(n) * 0.01
    zeros = np.zeros(n)
    record = pn.Telemetry.from_arrays(time_s=time_s, omega_rad_s=np.broadcast_to(zeros[:, None], (n, 3)))
    began = time.perf_counter()
    with pytest.raises(pn.InputError, match="every=") as refused:
        pn.identify(STSAT3, record)
    assert refused.value.code == "E0221" and time.perf_counter() - began < 20.0


def test_exact_errors_hold_code_place_and_advice(tmp_path):
    text = open(STSAT3).read().replace("mass_kg", "mass_lb")
    with pytest.raises(pn.InputError) as refused:
        pn.Model.from_text(text, "my.toml")
    error = refused.value
    assert error.code == "E0105" and error.place.startswith("my.toml:") and error.advice
    assert isinstance(error, ValueError) and isinstance(error, pn.PoinsotError)
    assert pn.explain(error.code).remedy
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.code == error.code
    with pytest.raises(pn.InputError, match="E0203") as cell:
        path = tmp_path / "t.csv"
        path.write_text(open(MULTIAXIS).read().replace("\n", "\nsoon", 2))
        pn.identify(STSAT3, path)
    assert str(path) in cell.value.place
    (tmp_path / "file").write_text("")
    with pytest.raises(pn.ResourceError) as refused_write:
        pn.Model.read(STSAT3).write(tmp_path / "file" / "x.toml")
    assert refused_write.value.code and isinstance(refused_write.value, OSError)
    answer = pn.identify(STSAT3, MULTIAXIS)
    for write in (answer.to_json, answer.report, lambda path: answer.export("csv", path)):
        with pytest.raises(pn.ResourceError, match="E0002") as refused_write:
            write(tmp_path / "file" / "x")
        assert refused_write.value.place == str(tmp_path / "file" / "x")
    for wrong in ({"name": object()}, {"body": {1: 2}}, {}, {"x": float("nan")}):
        with pytest.raises(pn.InputError):
            pn.Model.from_dict(wrong)


@pytest.mark.parametrize(
    "options",
    [{"method": "magic"}, {"variant": "x"}, {"every": 0}, {"encoding": "utf7"}, {"coordinates": "x"}, {"relative_accuracy": -1.0},
     {"policies": {"gap": "ignore"}}, {"time_s": (1e6, 2e6)}],
)  # fmt: skip
def test_exact_wrong_options_are_refused(options):
    with pytest.raises(pn.InputError) as refused:
        pn.identify(STSAT3, MULTIAXIS, **options)
    assert refused.value.advice and "--" not in str(refused.value)


def test_exact_dynamics_refuses_wrong_shapes():
    vehicle = pn.Model.read("data/xu2017/model.toml")
    dof = len(vehicle.coordinates)
    good = np.zeros((4, dof)), np.zeros((4, dof)), np.zeros((4, 6))
    for k, wrong in [(0, np.zeros((4, dof + 1))), (2, np.zeros(5)), (1, np.zeros((3, dof))), (2, np.zeros((4, 6), complex)), (0, 1.0)]:
        states = [*good[:k], wrong, *good[k + 1 :]]
        with pytest.raises(pn.InputError):
            pn.dynamics.momentum_regressor(vehicle, *states)
    with pytest.raises(pn.InputError):
        pn.dynamics.momentum_regressor(vehicle, *good, out=np.empty((4, 6, 80)))
    with pytest.raises(pn.InputError):
        pn.dynamics.jacobian(vehicle, "nobody", good[0])
    with pytest.raises(pn.InputError):
        pn.dynamics.momentum(vehicle, *good, parameters=np.zeros(7))
    none = pn.dynamics.momentum(vehicle, np.zeros((0, dof)), np.zeros((0, dof)), np.zeros((0, 6)))
    assert none.shape == (0, 6)
    nan = pn.dynamics.momentum(vehicle, np.full(dof, np.nan), np.zeros(dof), np.ones(6))
    assert np.isnan(nan).any()
    big = np.asfortranarray(np.random.default_rng(0).normal(size=(9, dof)))
    assert np.allclose(pn.dynamics.mass_matrix(vehicle, big), pn.dynamics.mass_matrix(vehicle, np.ascontiguousarray(big)))


def test_exact_threads(arrays, plain):
    """Fits at the same time, and Python goes on meanwhile."""
    found, ticks = [], 0
    threads = [threading.Thread(target=lambda: found.append(_inertia(**arrays))) for _ in range(4)]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        ticks += 1
        time.sleep(0.005)
    assert len(found) == 4 and all((f == plain).all() for f in found)
    assert ticks > 5


def _in_child(arrays, results):
    results.put(_inertia(**arrays))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_exact_fork(arrays, plain):
    """The child of a fork after a fit has none of its threads; it starts its own."""
    context = multiprocessing.get_context("fork")
    results = context.Queue()
    child = context.Process(target=_in_child, args=(arrays, results))
    child.start()
    found = results.get(timeout=60)
    child.join(60)
    assert (found == plain).all()


INTERRUPTED = """
import signal, sys, time, poinsot as pn
# A shell has its background jobs ignore the signal, and Python then leaves it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
print("ready", flush=True)
try:
    while True:
        pn.identify("{model}", "{telemetry}")
except KeyboardInterrupt:
    print(time.monotonic(), flush=True)
"""


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_exact_ctrl_c_within_a_fifth_of_a_second():
    """The best of some tries: a busy machine may hold one of them up."""
    assert min(_interrupted_after(seconds) for seconds in (0.3, 0.7, 1.1)) < 0.2


def _interrupted_after(seconds: float) -> float:
    """Seconds from the signal to the exception, in the middle of fits."""
    code = INTERRUPTED.format(model="data/xu2017/model.toml", telemetry="data/xu2017/C1/telemetry_noisy.parquet")
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "ready\n"
        time.sleep(seconds)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        caught = float(child.stdout.readline())
        assert child.wait(30) == 0
    return caught - sent
