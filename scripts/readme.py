#!/usr/bin/env python3
"""Keeps the numbers of README.md and of the book honest: fills in the output of the commands that they quote.

A line `<!-- output of: COMMAND -->` names a command; the block fenced by ```text after it is its standard
output. `poinsot` in a command is the program built from this checkout; pipes work.

    python3 scripts/readme.py                     run the commands, rewrite the blocks
    python3 scripts/readme.py --check             fail if a block is not what its command prints
    python3 scripts/readme.py --poinsot PATH      use a program that is already built
"""

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", ROOT / "docs/tutorial/first_fit.md", ROOT / "docs/howto/without_a_tracker.md"]
BLOCK = re.compile(r"<!-- output of: (?P<command>.+?) -->\n```text\n(?P<output>.*?)```\n", re.DOTALL)
CARGO = "cargo run --quiet --locked --release -p poinsot-cli --"


def output(command, program):
    """Standard output of a command; trailing blanks and blank lines at the end are dropped."""
    script = f'poinsot() {{ {program} "$@"; }}\n{command}'
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode > 1:
        sys.exit(f"readme.py: exit code {done.returncode}: {command}")
    lines = [line.rstrip() for line in done.stdout.rstrip().splitlines()]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poinsot", help="program to use; default: build it with cargo")
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.poinsot) if arguments.poinsot else CARGO
    stale = []
    known = {}

    def fill(match):
        command = match["command"]
        if command not in known:
            known[command] = output(command, program)
        if known[command] != match["output"]:
            stale.append(command)
        return f"<!-- output of: {command} -->\n```text\n{known[command]}```\n"

    for page in PAGES:
        name, before = page.relative_to(ROOT), len(stale)
        filled, blocks = BLOCK.subn(fill, page.read_text())
        if blocks == 0:
            sys.exit(f"readme.py: {name} quotes no output")
        if not arguments.check:
            page.write_text(filled)
        print(f"{name}: {blocks} outputs, {len(stale) - before} changed")
    if arguments.check and stale:
        sys.exit("out of date, run python3 scripts/readme.py:\n  " + "\n  ".join(stale))


if __name__ == "__main__":
    main()
