"""The verbs of Poinsot. Options are those of the command, with the same defaults and the same checks."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib import import_module
from typing import Any, TypeAlias

from . import _cluster, _core
from ._answer import Answer
from ._errors import InputError, data_frame
from ._model import Model
from ._telemetry import Telemetry, as_records

PathLike: TypeAlias = str | os.PathLike[str]
Progress: TypeAlias = Callable[[str, int, int], Any] | bool | None


class Document(Mapping[str, Any]):
    """A result as a dictionary, with the text that the command prints.

    Attributes
    ----------
    exit_code : int
        Exit code of the command.
    """

    def __init__(self, values: str, text: str, exit_code: int = 0) -> None:
        self._values: dict[str, Any] = json.loads(values)
        self._text = text
        self.exit_code = exit_code

    def __getitem__(self, key: str) -> Any:
        return self._values[key]

    def __iter__(self) -> Any:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<poinsot.{type(self).__name__} {self._values.get('schema', '')} {', '.join(self._values)}>"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<pre>{escape(self._text)}</pre>"


# Of a number in a campaign, those with an interval.
_BANDED = ("bias", "rmse", "rmse_over_bound", "coverage_answered", "coverage_all")


class CampaignResult(Document):
    """The statistics of a campaign or a sweep as a dictionary, with the text that the command prints."""

    def to_dataframe(self) -> Any:
        """Return the statistics as a data frame of pandas (``pip install 'poinsot[frames]'``).

        Returns
        -------
        pandas.DataFrame
            One row for each number that some trial determined, of each method at each point: ``experiment``, the varied numbers by
            their addresses, ``method``, ``number``, ``trials`` (those that determined it), ``bound``, ``stated``, then ``bias``,
            ``rmse``, ``rmse_over_bound``, ``coverage_answered`` and ``coverage_all``, each followed by the ends of its interval,
            ``bias_low``, ``bias_high`` ... NaN where there is none. The page of results explains them.

        Examples
        --------
        >>> import poinsot as pn
        >>> swept = pn.sweep("data/cases/stsat3_spin.toml", {"noise": [1, 2]}, trials=2)
        >>> frame = swept.to_dataframe()
        >>> bound = frame[frame.number == "spacecraft.inertia_kg_m2.xx"].set_index("noise").bound
        >>> bool(abs(bound[2.0] / bound[1.0] - 2.0) < 0.01)
        True
        """
        rows: list[dict[str, Any]] = []
        varied = list(dict.fromkeys(address for cell in self["cells"] for address in cell["at"]))
        for cell in self["cells"]:
            for method in cell["methods"]:
                head = {"experiment": cell["experiment"], **cell["at"], "method": method["method"]}
                rows += [head | _statistics(name, number) for name, number in method["numbers"].items()]
        ends = [f"{name}{end}" for name in _BANDED for end in ("", "_low", "_high")]
        return data_frame(rows, ["experiment", *varied, "method", "number", "trials", "bound", "stated", *ends])


def _statistics(name: str, number: Mapping[str, Any]) -> dict[str, Any]:
    """A row of the data frame of a campaign; null is NaN."""
    row: dict[str, Any] = {key: number[key] for key in ("trials", "bound", "stated")}
    for statistic in _BANDED:
        band = number[statistic]
        row |= {statistic: band["value"], f"{statistic}_low": band["low"], f"{statistic}_high": band["high"]}
    return {"number": name, **{key: math.nan if value is None else value for key, value in row.items()}}


class Simulation:
    """Simulated telemetry and the truth behind it.

    Attributes
    ----------
    telemetry : Telemetry
        What the sensors report.
    truth : dict
        The document ``truth.json``.
    """

    def __init__(self, telemetry: Telemetry, truth: dict[str, Any]) -> None:
        self.telemetry = telemetry
        self.truth = truth

    def __repr__(self) -> str:
        return f"<poinsot.Simulation {self.telemetry!r}>"


def _reporter(progress: Progress) -> Callable[[str, int, int], Any] | None:
    """The callback, or a bar of tqdm for True."""
    if progress is None or progress is False:
        return None
    if progress is not True:
        return progress
    try:
        tqdm: Any = import_module("tqdm.auto").tqdm
    except ImportError:
        raise InputError("E0001 progress True: tqdm is missing; pip install tqdm, or give a function of (stage, done, total)") from None
    bar = tqdm(leave=False)

    def report(stage: str, done: int, total: int) -> None:
        bar.set_description(stage)
        bar.total = total or None
        bar.n = done
        bar.refresh()

    return report


def as_model(vehicle: Model | PathLike) -> Model:
    """A model, or the file of one."""
    return vehicle if isinstance(vehicle, Model) else Model.read(vehicle)


def _options(**given: Any) -> dict[str, Any]:
    if given.get("map") is not None:
        given["map"] = os.fspath(given["map"])
    if given.get("time_s") is not None:
        given["time_s"] = [float(x) for x in given["time_s"]]
    policies = given.get("policies")
    if isinstance(policies, Mapping):
        given["policies"] = [f"{check}={policy}" for check, policy in policies.items()]
    return given


def identify(
    vehicle: Model | PathLike,
    records: Any,
    *,
    method: str = "auto",
    variant: str | None = None,
    settings: Mapping[str, object] | None = None,
    relative_accuracy: float = 1.0,
    coordinates: str | None = None,
    modes: str | None = None,
    strict: bool = False,
    repair: bool = False,
    policies: Mapping[str, str] | Sequence[str] | None = None,
    map: PathLike | None = None,
    recover: bool = False,
    encoding: str = "utf8",
    time_s: tuple[float, float] | None = None,
    every: int = 1,
    memory_mib: int | None = None,
    progress: Progress = None,
) -> Answer:
    """Identify the unknown mass properties of a vehicle from its telemetry.

    Parameters
    ----------
    vehicle
        The vehicle, or its model file.
    records
        Telemetry, file or data frame, or a sequence of them: one per segment. The bodies are shared, each segment has
        its own initial momentum.
    method, variant
        See :func:`methods`.
    settings
        Settings of a published method, for example ``{"particles": 40}``.
    relative_accuracy
        Half-width of the 95 % interval, relative to the nominal value, up to which a number is given.
    coordinates
        ``"physical"`` keeps every unknown body one of positive mass, ``"linear"`` lets an impossible tensor pass.
    modes
        ``"found"`` adds flexible modes that the data show and the model does not declare, ``"none"`` keeps it rigid.
    strict
        No repairs: what would be repaired is an error.
    repair
        Apply the lines of a map that a check or the diagnosis proposes; the answer lists them.
    policies
        What is done about a finding of a telemetry check, for example ``{"outlier": "report"}``.
    map
        File whose ``[telemetry]`` table replaces that of the model.
    recover
        Read the whole rows of a file that ends inside a row.
    encoding
        Of CSV text, ``"utf8"`` or ``"latin1"``.
    time_s
        Take the rows between these times, s.
    every
        Take every n-th row.
    memory_mib
        Most memory for the samples of one record, MiB; 64 by default.
    progress
        Called as ``progress(stage, done, total)``; True shows a bar of tqdm.

    Returns
    -------
    Answer

    Raises
    ------
    InputError
        Invalid arguments, model or telemetry. What the data do not determine is part of the answer.
    KeyboardInterrupt
        Within 0.2 s of Ctrl-C.

    Examples
    --------
    >>> import poinsot as pn
    >>> answer = pn.identify("data/stsat3/model.toml", "data/stsat3/multiaxis/telemetry_noisy.csv")
    >>> answer.rank
    (6, 6)
    """
    options = _options(
        method=method,
        variant=variant,
        settings=None if settings is None else [f"{key}={value}" for key, value in settings.items()],
        relative_accuracy=float(relative_accuracy),
        coordinates=coordinates,
        modes=modes,
        strict=strict,
        repair=repair,
        policies=policies,
        map=map,
        recover=recover,
        encoding=encoding,
        time_s=time_s,
        every=every,
        memory_mib=memory_mib,
    )
    return Answer(_core.identify(as_model(vehicle)._core, as_records(records), options, _reporter(progress)))


def check(vehicle: Model | PathLike) -> Document:
    """Check a model file and say what it describes.

    Parameters
    ----------
    vehicle
        The model, or its file.

    Examples
    --------
    >>> import poinsot as pn
    >>> pn.check("data/stsat3/model.toml")["mass_kg"]
    150.0
    """
    return Document(*as_model(vehicle)._core.check())


def inspect(
    *paths: PathLike,
    model: PathLike | None = None,
    map: PathLike | None = None,
    recover: bool = False,
    time_s: tuple[float, float] | None = None,
    every: int = 1,
    memory_mib: int | None = None,
    encoding: str = "utf8",
) -> Document:
    """Say what telemetry files hold and whether attitude and gyro fit the conventions of their names.

    Parameters
    ----------
    *paths
        Files of one segment.
    model
        Model file whose map of telemetry and mountings of sensors are used.
    map, recover, time_s, every, memory_mib, encoding
        As of :func:`identify`.

    Examples
    --------
    >>> import poinsot as pn
    >>> found = pn.inspect("data/stsat3/multiaxis/telemetry_noisy.csv")
    >>> found["sources"][0]["rows"]
    4801
    """
    files = [os.fspath(p) for p in paths]
    if not files:
        raise InputError("E0001 paths: no file; give at least one")
    span = None if time_s is None else (float(time_s[0]), float(time_s[1]))
    return Document(*_core.inspect(files, model, map, recover, span, every, memory_mib, encoding))


def simulate(case: PathLike, *, out: PathLike | None = None, progress: Progress = None) -> Simulation:
    """Simulate a case: joints, wheels, thrusters, sensors with noise.

    Parameters
    ----------
    case
        Case file (TOML, ``poinsot.case/2``).
    out
        Folder for telemetry and ``truth.json``, written as the command does; in memory without.
    progress
        As of :func:`identify`.
    """
    record, truth = _core.simulate(case, out, _reporter(progress))
    return Simulation(Telemetry._of(record), json.loads(truth))


def predict(
    case: PathLike | Sequence[PathLike],
    *,
    relative_accuracy: float = 1.0,
    durations: bool = False,
    out: PathLike | None = None,
    progress: Progress = None,
) -> Document:
    """Say how accurate a planned manoeuvre will be, before it is flown (Cramer-Rao bound).

    Parameters
    ----------
    case
        Case file; the numbers of its model are taken as the truth. Of several files the document has one entry each,
        under the path as given.
    durations
        Sigmas for shorter records, too.
    out
        Folder for ``prediction.json``; of several cases each has its own folder there.
    relative_accuracy, progress
        As of :func:`identify`.
    """
    cases = [case] if isinstance(case, (str, os.PathLike)) else list(case)
    if not cases:
        raise InputError("E0001 case: there is no case; give one path or more")
    printed, text, exit_code = _core.predict(cases, float(relative_accuracy), durations, out, _reporter(progress))
    found = json.loads(printed)
    whole = found[0] if len(found) == 1 else {os.fspath(path): values for path, values in zip(cases, found)}
    return Document(json.dumps(whole), text, exit_code)


def validate(
    against: PathLike | Sequence[PathLike],
    *,
    case: PathLike | None = None,
    model: PathLike | None = None,
    estimate: PathLike | None = None,
    map: PathLike | None = None,
    within_m: float | None = None,
    within_rad: float | None = None,
    strict: bool = False,
    recover: bool = False,
    out: PathLike | None = None,
) -> Document:
    """Compare the motion of a model, or of an estimate, with another model or with telemetry.

    Parameters
    ----------
    against
        Another model (``.toml``), or telemetry files of one record.
    case
        Case that says what drives the vehicle; not needed for held-back telemetry.
    model
        Model of the vehicle; that of the case where it is not given.
    estimate
        Folder of an answer (:meth:`Answer.write`) whose numbers replace the nominal ones.
    within_m, within_rad
        Largest acceptable difference of positions and of angles.
    out
        Folder for ``validation.json`` and ``histories.csv``.
    map, strict, recover
        As of :func:`identify`.
    """
    files = [against] if isinstance(against, (str, os.PathLike)) else list(against)
    joined = ",".join(os.fspath(p) for p in files)
    return Document(*_core.validate(joined, case, model, estimate, map, within_m, within_rad, strict, recover, out))


def design(
    case: PathLike,
    *,
    out: PathLike | None = None,
    after: PathLike | None = None,
    accept_unreliable: bool = False,
    minutes: float | None = None,
    verify: int = 0,
    front: str | Sequence[str] = (),
    progress: Progress = None,
) -> Document:
    """Search the manoeuvre that gives the wanted accuracy within the limits of a case.

    Parameters
    ----------
    case
        Case file with ``[[want]]``, ``[limits]`` and ``[design]``.
    out
        Folder for ``case.toml``, ``model.toml``, ``commands.csv`` and ``design.json``.
    after
        ``estimate.json``, or its folder, of the records so far: its values are the nominal ones, and the sigmas include its
        covariance.
    accept_unreliable
        Design after an answer that is not reliable too.
    minutes
        Ends the search after this time with the best manoeuvre so far.
    verify
        Number of simulated flights whose errors are compared with the predicted sigmas.
    front
        Kind of limit, as ``"duration"`` or ``"wheel-speeds=0.5,1,2"``, or two of them: the accuracy is also given with these limits
        tighter and looser, by these factors.
    progress
        As of :func:`identify`.
    """
    front = [front] if isinstance(front, str) else list(front)
    return Document(*_core.design(case, out, after, accept_unreliable, minutes, verify, front, _reporter(progress)))


def campaign(
    plan: PathLike,
    *,
    out: PathLike | None = None,
    trials: int | None = None,
    resume: bool = False,
    until: float | None = None,
    client: Any = None,
    progress: Progress = None,
) -> CampaignResult:
    """Run the simulated trials of a plan, on all cores of this machine or on a cluster, and return their statistics.

    Parameters
    ----------
    plan
        Plan file (TOML, ``poinsot.plan/1``).
    out
        Folder for shards, ``campaign.json`` and ``campaign.html``; in memory without. A URL as ``s3://bucket/run`` is
        a folder of an object store (fsspec).
    trials
        Trials of each experiment, in place of the number in the plan.
    resume
        Run the shards that are missing in ``out``.
    until
        Stop when no confidence interval of coverage is wider than twice this share; needs ``out``.
    client
        Client of Dask (``dask.distributed.Client``) whose workers run the shards. The result has the same bits.
    progress
        As of :func:`identify`.

    Examples
    --------
    >>> import poinsot as pn
    >>> found = pn.campaign("data/campaigns/ma_traj1.toml", trials=4)
    >>> [cell["methods"][0]["trials"] for cell in found["cells"]][0]
    4
    """
    if until is not None and out is None:
        raise InputError("E0001 until: it needs a folder for the shards; give out=")
    return _campaign(_core.Plan.read(plan, trials), out, resume, until, client, progress)


def _campaign(
    plan: _core.Plan, out: PathLike | None, resume: bool, until: float | None, client: Any, progress: Progress
) -> CampaignResult:
    place = None if out is None else os.fspath(out)
    return CampaignResult(*_cluster.campaign(plan, place, resume, until, client, _reporter(progress)))


def sweep(
    case: PathLike,
    vary: Mapping[str, Iterable[float]],
    *,
    methods: Iterable[str] = ("auto",),
    settings: Iterable[str] = (),
    trials: int = 100,
    model: PathLike | None = None,
    seed: int | None = None,
    out: PathLike | None = None,
    resume: bool = False,
    client: Any = None,
    progress: Progress = None,
) -> CampaignResult:
    """Repeat simulated trials of one case over numbers that vary, with one or several methods.

    Parameters
    ----------
    case
        Case file.
    vary
        Values of each number by its address, for example ``{"noise": [1, 2, 5]}``.
    methods
        Names of methods, with a variant as ``name/variant``.
    settings
        Settings of published methods as ``key=value``.
    trials
        Trials at each point.
    model
        Model as the identification knows it; that of the case without.
    seed
        Seed of the trials.
    out, resume, client, progress
        As of :func:`campaign`.
    """
    numbers = [f"{name}={','.join(repr(float(v)) for v in values)}" for name, values in vary.items()]
    plan = _core.Plan.of_sweep(case, numbers, list(methods), list(settings), trials, model, seed)
    return _campaign(plan, out, resume, None, client, progress)


def study(paper: str, name: str, *, data: PathLike = "data", progress: Progress = None) -> Document:
    """Repeat one study of a published paper, for example ``study("kim2010", "table2")``.

    Parameters
    ----------
    paper, name
        Paper and study, as ``poinsot study`` lists them.
    data
        Folder of the shipped data.
    progress
        As of :func:`identify`.
    """
    return Document(*_core.study(paper, name, data, _reporter(progress)))


def compare(answers: Iterable[Answer | PathLike]) -> Document:
    """Compare answers of one vehicle: differences in sigma, joint tests, pooled answer.

    Parameters
    ----------
    answers
        Two or more: answers, or folders of them. Their telemetry must be different.
    """
    return Document(*_core.compare([a._core if isinstance(a, Answer) else os.fspath(a) for a in answers]))


def export(answer: Answer, to: str, path: PathLike | None = None, *, onto: PathLike | None = None) -> str:
    """Write the numbers of an answer into the file of another program.

    Parameters
    ----------
    answer
        The answer.
    to, path, onto
        As in :meth:`Answer.export`.
    """
    return answer.export(to, path, onto=onto)


def methods() -> list[dict[str, Any]]:
    """List the methods of :func:`identify` with their variants and papers.

    Examples
    --------
    >>> import poinsot as pn
    >>> [m["name"] for m in pn.methods()][:3]
    ['auto', 'linear', 'maximum_likelihood']
    """
    found: list[dict[str, Any]] = json.loads(_core.methods())
    return found


def units() -> list[dict[str, Any]]:
    """List the units that a map of telemetry may name, with their factors to SI."""
    found: list[dict[str, Any]] = json.loads(_core.units())
    return found
