"""Where the data stand, and the command that the package is compared with."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def pytest_configure() -> None:
    """Doctests and examples name files from the root of the repository."""
    os.chdir(ROOT)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Examples of data frames need pandas, as the tests that are marked so."""
    for item in items:
        examples = item.dtest.examples if isinstance(item, pytest.DoctestItem) else ()
        if any("to_dataframe" in example.source for example in examples):
            item.add_marker(pytest.mark.extra)


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def command():
    """Run the command: the program of POINSOT where it is set, else that of the package."""
    program = os.environ.get("POINSOT")
    words = [program] if program else [sys.executable, "-m", "poinsot"]

    def run(*arguments: object, **options: object) -> subprocess.CompletedProcess:
        return subprocess.run([*words, *map(str, arguments)], capture_output=True, text=True, timeout=300, **options)

    return run
