#!/usr/bin/env python3
"""Run the notebooks and keep their outputs: python python/pages/notebooks.py [NAME ...], all of them without a name.

Needs the package poinsot, nbclient, ipykernel and what the notebooks name. python/tests/test_notebooks.py runs them as well and
compares what they say.
"""

import sys
import tempfile
from pathlib import Path
from typing import Any

import nbclient
import nbformat

FOLDER = Path(__file__).resolve().parents[1] / "notebooks"


def executed(path: Path, folder: Path) -> Any:
    """The notebook with new outputs, run in a folder."""
    notebook = nbformat.read(path, as_version=4)
    metadata = dict(notebook.metadata)
    resources = {"metadata": {"path": str(folder)}}
    nbclient.NotebookClient(notebook, timeout=300, record_timing=False, resources=resources).execute()
    # Without the version of Python that ran it.
    notebook.metadata = nbformat.from_dict(metadata)
    return notebook


def main() -> None:
    for path in sorted(FOLDER.glob("*.ipynb")):
        if sys.argv[1:] and path.stem not in sys.argv[1:]:
            continue
        with tempfile.TemporaryDirectory() as elsewhere:
            notebook = executed(path, Path(elsewhere))
        nbformat.write(notebook, path)
        print(f"{path.name}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
