from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Answer",
    "Model",
    "Problem",
    "Record",
    "after_fork",
    "campaign",
    "command",
    "compare",
    "design",
    "error_codes",
    "explain",
    "forward_dynamics",
    "identify",
    "inspect",
    "integrate",
    "jacobian",
    "mass_matrix",
    "methods",
    "momentum",
    "momentum_regressor",
    "predict",
    "simulate",
    "study",
    "sweep",
    "units",
    "validate",
    "version",
]

_Path = str | PathLike[str]
_Array = NDArray[np.float64]
_Progress = Callable[[str, int, int], Any] | None

@final
class Model:
    @staticmethod
    def read(path: _Path) -> Model: ...
    @staticmethod
    def from_urdf(path: _Path) -> Model: ...
    @staticmethod
    def from_text(text: str, name: str | None = None) -> Model: ...
    @staticmethod
    def from_dict(values: object) -> Model: ...
    def with_map(self, path: _Path) -> Model: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def write(self, path: _Path) -> None: ...
    def check(self) -> tuple[str, str]: ...
    @property
    def name(self) -> str: ...
    @property
    def bodies(self) -> list[str]: ...
    @property
    def coordinates(self) -> list[str]: ...
    @property
    def coordinate_units(self) -> list[str]: ...
    @property
    def wheels(self) -> list[str]: ...
    @property
    def thrusters(self) -> list[str]: ...
    @property
    def sensors(self) -> list[str]: ...
    @property
    def parameters(self) -> list[list[float]]: ...

@final
class Record:
    @staticmethod
    def of_files(paths: Sequence[_Path]) -> Record: ...
    @staticmethod
    def of_columns(name: str, columns: Sequence[tuple[str, NDArray[Any]]]) -> Record: ...
    @staticmethod
    def of_bytes(name: str, bytes: bytes) -> Record: ...
    @staticmethod
    def join(records: Sequence[Record]) -> Record: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def is_files(self) -> bool: ...
    def channels(self) -> dict[str, tuple[_Array, _Array]]: ...

@final
class Answer:
    def json(self) -> str: ...
    def text(self, width: int | None = None) -> str: ...
    def html(self) -> str: ...
    def write(self, folder: _Path, report: bool = False, figures: Sequence[str] = ...) -> list[Any]: ...
    def export(self, to: str, onto: _Path | None = None) -> tuple[str, list[str]]: ...
    def predictions(self) -> list[dict[str, Any]]: ...
    @property
    def exit_code(self) -> int: ...
    @property
    def wheel_sensitivity(self) -> float | None: ...

@final
class Problem:
    def __new__(cls, model: Model, records: Sequence[Record], options: dict[str, Any]) -> Problem: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def nominal(self) -> _Array: ...
    @property
    def repairs(self) -> list[str]: ...
    def evaluate(self, theta: _Array) -> dict[str, Any]: ...

def identify(model: Model, records: Sequence[Record], options: dict[str, Any], progress: _Progress = None) -> Answer: ...
def inspect(
    paths: Sequence[_Path],
    model: _Path | None = None,
    map: _Path | None = None,
    recover: bool = False,
    time_s: tuple[float, float] | None = None,
    every: int = 1,
    memory_mib: int | None = None,
    encoded: str = "utf8",
) -> tuple[str, str]: ...
def simulate(case: _Path, out: _Path | None = None, progress: _Progress = None) -> tuple[Record, str]: ...
def predict(case: _Path, relative_accuracy: float = 1.0, progress: _Progress = None) -> tuple[str, str, int]: ...
def validate(
    against: str,
    case: _Path | None = None,
    model: _Path | None = None,
    estimate: _Path | None = None,
    map: _Path | None = None,
    within_m: float | None = None,
    within_rad: float | None = None,
    strict: bool = False,
    recover: bool = False,
    out: _Path | None = None,
) -> tuple[str, str, int]: ...
def design(
    case: _Path, out: _Path | None = None, minutes: float | None = None, verify: int = 0, progress: _Progress = None
) -> tuple[str, str, int]: ...
def campaign(
    plan: _Path,
    out: _Path | None = None,
    trials: int | None = None,
    resume: bool = False,
    until: float | None = None,
    progress: _Progress = None,
) -> tuple[str, str, int]: ...
def sweep(
    case: _Path,
    vary: Sequence[str],
    methods: Sequence[str],
    settings: Sequence[str],
    trials: int,
    model: _Path | None = None,
    seed: int | None = None,
    out: _Path | None = None,
    resume: bool = False,
    progress: _Progress = None,
) -> tuple[str, str, int]: ...
def study(paper: str, name: str, examples: _Path, progress: _Progress = None) -> tuple[str, str, int]: ...
def compare(answers: Sequence[Answer | _Path]) -> tuple[str, str, int]: ...
def methods() -> str: ...
def units() -> str: ...
def explain(code: str) -> tuple[str, str, str, str] | None: ...
def error_codes() -> list[str]: ...
def version() -> str: ...
def after_fork() -> None: ...
def command(words: Sequence[str]) -> int: ...
def momentum_regressor(model: Model, q: _Array, dq: _Array, V: _Array, out: _Array) -> None: ...
def momentum(model: Model, q: _Array, dq: _Array, V: _Array, out: _Array, parameters: _Array | None = None) -> None: ...
def mass_matrix(model: Model, q: _Array, out: _Array, parameters: _Array | None = None) -> None: ...
def jacobian(
    model: Model,
    body: int,
    point: Sequence[float],
    q: _Array,
    out: _Array,
    generalised: bool = False,
    parameters: _Array | None = None,
) -> None: ...
def forward_dynamics(
    model: Model,
    q: _Array,
    dq: _Array,
    V: _Array,
    tau: _Array,
    wrench: _Array,
    out: _Array,
    parameters: _Array | None = None,
) -> None: ...
def integrate(
    model: Model,
    times: Sequence[float],
    q: _Array,
    dq: _Array,
    start: _Array,
    tau: _Array,
    out: _Array,
    parameters: _Array | None = None,
) -> None: ...
