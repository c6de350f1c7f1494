#!/usr/bin/env python3
"""Write docs/reference/python_api.md from the docstrings of the Python package; with --check, say whether it is up to date.

Needs the package poinsot and griffe2md.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/reference/python_api.md"
HEAD = """# Python reference

Generated from the docstrings of the package by `scripts/python-api`. [Python](../howto/python.md) shows how to use it.

"""


def page() -> str:
    """The page of griffe2md without its links, whose anchors the book does not have."""
    done = subprocess.run(["griffe2md", "poinsot"], cwd=ROOT, capture_output=True, text=True, check=True)
    text = re.sub(r"\[([^\[\]]*)\]\(#[^)]*\)", r"\1", done.stdout)
    text = re.sub(r":(?:func|meth|class|mod):`[~.]?([^`]*)`", r"`\1`", text)
    text = re.sub(r"(?<!`)``(?!`)", "`", text)
    # Examples as code.
    lines, code, fenced = [], False, False
    for line in text.splitlines():
        fenced ^= line.startswith("```")
        example = not fenced and (line.startswith((">>> ", "... ")) or (code and line.strip() != ""))
        if example and not code:
            lines.append("```python")
            code = True
        elif code and not example:
            lines.append("```")
            code = False
        lines.append(line.rstrip())
    return HEAD + re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip() + "\n"


def main() -> None:
    written = page()
    if "--check" in sys.argv[1:]:
        if not PAGE.exists() or PAGE.read_text() != written:
            sys.exit("docs/reference/python_api.md is not what the docstrings say: run scripts/python-api")
        return
    PAGE.write_text(written)


if __name__ == "__main__":
    main()
