"""The command `poinsot`: `python -m poinsot identify --model ...`."""

import sys

from ._core import command


def main() -> None:
    """Run the command with the words of `sys.argv` and leave with its exit code."""
    sys.exit(command(["poinsot", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
