"""The program that scripts run: one that is given, or target/release/poinsot, built first."""

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def add_option(parser):
    parser.add_argument("--poinsot", help="program to use; default: build it with cargo")


def program(given=None):
    """Absolute path of the program."""
    if given is None:
        # With the tests selected the features are those of the tests of the workspace, so that nothing is compiled twice.
        subprocess.run(["cargo", "build", "--quiet", "--locked", "--release", "--workspace", "--bins", "--tests"], cwd=ROOT, check=True)
        given = ROOT / "target/release/poinsot"
    return str(Path(given).resolve())
