"""The notebooks are committed as they run: from any folder, with their outputs and without what belongs to one machine."""

import json
import re
import runpy
from pathlib import Path

import pytest

import poinsot as pn

NOTEBOOKS = sorted((Path(__file__).resolve().parents[1] / "notebooks").glob("*.ipynb"))
PACKAGES = {
    "first_fit": ["matplotlib"],
    "robot_from_mujoco": ["mujoco", "matplotlib"],
    "observability": ["matplotlib"],
    "own_estimator": ["scipy"],
    "basilisk_satellite": ["Basilisk", "matplotlib"],
}
# The largest one has 203 kB, of which a figure of residuals is 139.
MOST_BYTES = 400_000
# Paths from the root of a disk, and dates of a run.
OF_ONE_MACHINE = re.compile(r"(?<![\w./<])/(?:home|root|tmp|usr|var|work|Users|private|mnt|opt)/|[A-Z]:\\\\|\d{4}-\d\d-\d\dT\d\d:")


def _code(notebook):
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def _text(value):
    return value if isinstance(value, str) else "".join(value)


def _shown(cell):
    """Kinds of the outputs of a cell and the words of their text, whose last digits belong to the machine."""
    shown = []
    for output in cell["outputs"]:
        text = _text(output.get("text", output.get("data", {}).get("text/plain", "")))
        shown.append((output["output_type"], sorted(output.get("data", {})), re.findall(r"[A-Za-z_]{3,}", text)))
    return shown


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_unit_notebooks_are_committed_with_their_outputs(path):
    """Run from the first cell to the last, small, and free of paths, dates and the version of Python."""
    text = path.read_text(encoding="utf-8")
    notebook = json.loads(text)
    cells = _code(notebook)
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell["outputs"]]
    assert outputs and all(output["output_type"] in ("stream", "execute_result") for output in outputs)
    assert all(output.get("name") != "stderr" for output in outputs)
    # A cell that ends in a figure or a value shows it.
    for cell in cells:
        last = _text(cell["source"]).splitlines()[-1]
        if last.startswith("print(") or re.match(r"\w+\.plot\(|plot\.", last):
            assert cell["outputs"], last
        if re.match(r"\w+\.plot\(|plot\.", last):
            assert "<svg" in _text(cell["outputs"][-1]["data"]["image/svg+xml"])
    assert not OF_ONE_MACHINE.search(text), OF_ONE_MACHINE.search(text)
    assert list(notebook["metadata"]) == ["kernelspec"] and not any(cell["metadata"] for cell in cells)
    assert len(text.encode()) < MOST_BYTES


@pytest.mark.extra
@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_cli_notebooks_run_from_another_folder(path, root, tmp_path, monkeypatch):
    """The same code, with the same kinds of outputs and the same words in each cell."""
    pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    for package in PACKAGES[path.stem]:
        pytest.importorskip(package)
    if root not in Path(pn.__file__).resolve().parents:
        monkeypatch.setenv("POINSOT_ROOT", str(root))
    committed = json.loads(path.read_text(encoding="utf-8"))
    run = runpy.run_path(str(root / "python/pages/notebooks.py"))["executed"](path, tmp_path)
    assert len(_code(run)) == len(_code(committed))
    for ours, theirs in zip(_code(run), _code(committed)):
        source = _text(theirs["source"])
        assert ours["source"] == source
        assert _shown(ours) == _shown(theirs), f"run python python/pages/notebooks.py {path.stem}: other outputs of\n{source}"
