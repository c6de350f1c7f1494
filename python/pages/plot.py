#!/usr/bin/env python3
"""Draws docs/assets/plot.svg, the figure of docs/howto/python.md, by `Answer.plot`; with --check, says whether it is up to date.

Needs the package poinsot and matplotlib. Compared are the words of the figure: lines differ in the last digit from one
version of matplotlib to the next.
"""

import os
import re
import sys
from pathlib import Path

import poinsot as pn

ROOT = Path(__file__).resolve().parents[2]
PICTURE = ROOT / "docs/assets/plot.svg"


def drawn() -> str:
    os.chdir(ROOT)
    answer = pn.identify("data/stsat3/model.toml", "data/stsat3/multiaxis/telemetry_noisy.csv")
    return answer.plot()._repr_svg_()


def words(picture: str) -> list[str]:
    """The texts of a figure, formulas in parts."""
    return re.findall(r">([^<>\s][^<>]*)</(?:text|tspan)>", picture)


def main() -> None:
    written = drawn()
    if "--check" in sys.argv[1:]:
        if not PICTURE.exists() or words(PICTURE.read_text()) != words(written):
            sys.exit("docs/assets/plot.svg is not what Answer.plot draws: run python python/pages/plot.py")
        return
    PICTURE.write_text(written)


if __name__ == "__main__":
    main()
