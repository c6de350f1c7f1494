#!/usr/bin/env python3
"""Keeps the outputs on pages honest: runs the commands that README and the book quote, and fills in what they print.

A line `<!-- output of: COMMAND -->` names a command; the block fenced by ```text after it is its standard output. The block
fenced by ```console after `<!-- run: COMMAND -->` shows the command too; `&&` begins a new line.
Between `<!-- lines of: COMMAND -->` and `<!-- end of lines -->` stands every line of the output with the sentence of
docs/reference/output_lines.txt that explains it; a line without a sentence is an error. `poinsot` in a command is the
program built from this checkout; pipes work. Commands of a page run in the order of the page.

    python3 scripts/readme.py                     run the commands, rewrite the blocks
    python3 scripts/readme.py --check             fail if a block is not what its command prints
    python3 scripts/readme.py --poinsot PATH      use a program that is already built
"""

import argparse
import re
import subprocess
import sys

from program import ROOT, add_option, program

SENTENCES = ROOT / "docs/reference/output_lines.txt"
OUTPUT = r"<!-- output of: (?P<command>.+?) -->\n```text\n(?P<output>.*?)```\n"
LINES = r"<!-- lines of: (?P<explained>.+?) -->\n(?P<sentences>.*?)<!-- end of lines -->\n"
RUN = r"<!-- run: (?P<run>.+?) -->\n```console\n(?P<console>.*?)```\n"
BLOCK = re.compile(f"{OUTPUT}|{RUN}|{LINES}", re.DOTALL)
LONGEST = 110  # characters of a line of a command


def pages():
    """Pages that quote an output."""
    found = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return [page for page in found if BLOCK.search(page.read_text())]


def output(command, poinsot):
    """Standard output of a command; trailing blanks and blank lines at the end are dropped."""
    script = f'poinsot() {{ {poinsot} "$@"; }}\n{command}'
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode > 1:
        sys.exit(f"readme.py: exit code {done.returncode}: {command}")
    lines = [line.rstrip() for line in done.stdout.rstrip().splitlines()]
    return "\n".join(lines) + "\n"


def shown(command):
    """A command as a person types it, options on lines of their own where it is long."""
    lines = []
    for part in command.removesuffix(" 2>&1").split(" && "):
        lines.append("$ " + (part if len(part) <= LONGEST else re.sub(r" (--[a-z])", r" \\\n    \1", part)))
    return "\n".join(lines) + "\n"


def explained(printed):
    """Every line of an output, those of one sentence together, then the sentence."""
    rules = [line.split(" => ") for line in SENTENCES.read_text().splitlines() if " => " in line and line[0] != "#"]
    groups = []
    for line in filter(None, printed.splitlines()):
        sentence = next((sentence for pattern, sentence in rules if re.fullmatch(pattern, line.strip())), None)
        if sentence is None:
            sys.exit(f"readme.py: no pattern of {SENTENCES.relative_to(ROOT)} explains the line\n  {line}")
        if not groups or groups[-1][1] != sentence:
            groups.append(([], sentence))
        groups[-1][0].append(line)
    blocks = ["```text\n" + "\n".join(lines) + f"\n```\n\n{sentence}\n" for lines, sentence in groups]
    return "\n" + "\n".join(blocks) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add_option(parser)
    parser.add_argument("--check", action="store_true", help="compare instead of writing")
    arguments = parser.parse_args()
    poinsot = program(arguments.poinsot)
    stale = []
    known = {}

    def run(command):
        if command not in known:
            known[command] = output(command, poinsot)
        return known[command]

    def fill(match):
        if match["command"]:
            command, kept = match["command"], match["output"]
            filled = run(command)
            block = f"<!-- output of: {command} -->\n```text\n{filled}```\n"
        elif match["run"]:
            command, kept = match["run"], match["console"]
            filled = shown(command) + run(command)
            block = f"<!-- run: {command} -->\n```console\n{filled}```\n"
        else:
            command, kept = match["explained"], match["sentences"]
            filled = explained(run(command))
            block = f"<!-- lines of: {command} -->\n{filled}<!-- end of lines -->\n"
        if filled != kept:
            stale.append(command)
        return block

    for page in pages():
        name, before = page.relative_to(ROOT), len(stale)
        filled, blocks = BLOCK.subn(fill, page.read_text())
        if not arguments.check:
            page.write_text(filled)
        print(f"{name}: {blocks} outputs, {len(stale) - before} changed")
    if arguments.check and stale:
        sys.exit("out of date, run python3 scripts/readme.py:\n  " + "\n  ".join(stale))


if __name__ == "__main__":
    main()
