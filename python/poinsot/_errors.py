"""What can go wrong: three exceptions, each with code, place and advice."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, NamedTuple, TypeVar

from . import _core

T = TypeVar("T")

_CODE = re.compile(r"^(E\d{4}) ")
# Options of the command are keyword arguments here: --relative-accuracy is relative_accuracy=.
_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)")
_QUOTED = re.compile(r"'[^']*'|\"[^\"]*\"")


class PoinsotError(Exception):
    """Base class of all errors of Poinsot.

    Parameters
    ----------
    message
        One line per finding: code, place, value as read, what is wrong, what to do.

    Attributes
    ----------
    code : str
        Stable code, for example ``"E0203"``; see :func:`poinsot.explain`.
    place : str
        File with line or row, column or key, or the argument.
    advice : str
        What to do.
    lines : tuple of str
        All findings; a model file may have several.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.lines: tuple[str, ...] = tuple(message.splitlines()) or ("",)
        first = self.lines[0]
        found = _CODE.match(first)
        self.code: str = found.group(1) if found else ""
        rest = first[found.end() :] if found else first
        # Separators inside of quotes belong to the value.
        plain = _QUOTED.sub(lambda quoted: "\0" * len(quoted.group()), rest)
        end = plain.find(": ")
        self.place: str = rest[:end] if end > 0 else ""
        begin = plain.find("; ")
        explained = explain(self.code) if self.code else None
        remedy = explained.remedy if explained else ""
        self.advice: str = rest[begin + 2 :] if begin > 0 else remedy

    def __reduce__(self) -> tuple[type[PoinsotError], tuple[str]]:
        return (type(self), (str(self),))


class InputError(PoinsotError, ValueError):
    """Invalid arguments, model, case or telemetry (exit code 2 of the command)."""


class ResourceError(PoinsotError, OSError):
    """The system refuses: disk, permission, memory, threads (exit code 3 of the command)."""

    def __str__(self) -> str:
        return "\n".join(self.lines)


class InternalError(PoinsotError, RuntimeError):
    """A fault of Poinsot (exit code 4 of the command). Please report it."""


class Explanation(NamedTuple):
    """Meaning of an error code.

    Attributes
    ----------
    code, meaning, cause, remedy
        The code, what it means, what usually causes it, what to do.
    """

    code: str
    meaning: str
    cause: str
    remedy: str


def explain(code: str) -> Explanation | None:
    """Say what an error code means.

    Parameters
    ----------
    code
        For example ``"E0203"``.

    Returns
    -------
    Explanation or None
        None for an unknown code.

    Examples
    --------
    >>> import poinsot as pn
    >>> pn.explain("E0207").code
    'E0207'
    """
    found = _core.explain(code)
    return None if found is None else Explanation(*found)


def of(exit_code: int, message: str) -> PoinsotError:
    """Make the exception of an error line of the command."""
    kinds: dict[int, type[PoinsotError]] = {2: InputError, 3: ResourceError}
    text = _OPTION.sub(lambda option: option.group(1).replace("-", "_") + "=", message)
    return kinds.get(exit_code, InternalError)(text)


def need(package: str, extra: str) -> Any:
    """Import a package that an extra brings."""
    try:
        return import_module(package)
    except ImportError:
        raise InputError(f"E0001 {package}: this package is missing; pip install 'poinsot[{extra}]'") from None


def data_frame(rows: Any, columns: Sequence[str] | None = None) -> Any:
    """A data frame of pandas, which is imported here alone."""
    return need("pandas", "frames").DataFrame(rows, columns=None if columns is None else list(columns))


def read_by(path: str | os.PathLike[str], read: Callable[[], T], *, missing: str = "E0201", broken: str = "E0202") -> T:
    """Call the reader of another package; what it raises becomes an InputError of one of two codes."""
    if not os.path.exists(path):
        raise InputError(f"{missing} {os.fspath(path)}: there is no such file; check the path")
    try:
        return read()
    except PoinsotError:
        raise
    # Readers of other packages raise exceptions of any type.
    except Exception as error:
        message = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{broken} {os.fspath(path)}: it cannot be read ({message}); correct the file") from error


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a file, with the line ends of the text."""
    try:
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write(text)
    except OSError as error:
        raise ResourceError(f"E0002 {os.fspath(path)}: cannot be written: {error.strerror}; correct the path or the permission") from error
