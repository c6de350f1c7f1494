"""The notebooks run from their first cell to their last."""

from pathlib import Path

import pytest

pytestmark = [pytest.mark.extra, pytest.mark.slow]

NOTEBOOKS = sorted((Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb"))
PACKAGES = {
    "first_fit": ["matplotlib"],
    "robot_from_mujoco": ["mujoco", "matplotlib"],
    "observability": ["matplotlib"],
    "own_estimator": ["scipy"],
    "basilisk_satellite": ["Basilisk", "matplotlib"],
}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_cli_notebook_runs(path, root):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for package in PACKAGES[path.stem]:
        pytest.importorskip(package)
    notebook = nbformat.read(path, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "notebooks are kept without output"
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(root)}}).execute()
