"""A commissioning in three segments: each manoeuvre is designed after the answer to the segments before it.

    python examples/05_design/commissioning.py

The vehicle that flies is data/cases/stsat3_truth.toml; design and identification begin with the nominal model.
"""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import poinsot as pn

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "examples/05_design/segment.toml"
NOMINAL = ROOT / "data/stsat3/model.toml"
TRUTH = ROOT / "data/cases/stsat3_truth.toml"
STEPS = 3


def fly(folder: Path, step: int) -> dict[str, Any]:
    """Simulate a designed manoeuvre with the true vehicle and sensor noise of its own; return the truth."""
    case = (folder / "case.toml").read_text()
    case = re.sub(r"(?m)^model = .*", f'model = "{TRUTH}"', case)
    case = re.sub(r"(?m)^seed = .*", f"seed = {step}", case)
    (folder / "flight.toml").write_text(case)
    return pn.simulate(folder / "flight.toml", out=folder).truth


def errors(answer: pn.Answer, truth: dict[str, Any], names: list[str]) -> list[float]:
    """Estimate less true value of each number, by its address."""
    found = []
    for name in names:
        body, quantity, element = name.split(".")
        numbers = [document["bodies"][body][quantity][element]["value"] for document in (answer.to_dict(), truth)]
        found.append(numbers[0] - numbers[1])
    return found


def commission(folder: Path) -> list[dict[str, Any]]:
    """Names, wanted, predicted and achieved sigmas, errors and covariance after each step."""
    records: list[Path] = []
    after: Path | None = None
    steps = []
    for step in range(1, STEPS + 1):
        here = folder / f"step{step}"
        design = pn.design(CASE, out=here, after=after)
        truth = fly(here, step)
        records.append(here / "telemetry.csv")
        answer = pn.identify(NOMINAL, records)
        answer.write(here)
        after = here
        names = [want["name"] for want in design["wants"]]
        rows = [answer.covariance.names.index(name) for name in names]
        covariance = answer.covariance.matrix[np.ix_(rows, rows)]
        steps.append(
            {
                "names": names,
                "wanted": np.array([want["wanted_sigma"] for want in design["wants"]]),
                "predicted": np.array([want["sigma"] for want in design["wants"]]),
                "achieved": np.sqrt(covariance.diagonal()),
                "error": np.array(errors(answer, truth, names)),
                "covariance": covariance,
            }
        )
    return steps


def table(steps: list[dict[str, Any]]) -> str:
    """One row a number: sigmas in g m2, predicted and achieved after each step, and the last error."""
    head = "sigma, g m2".ljust(28) + "wanted".rjust(7)
    head += "".join(f"predicted {k}".rjust(13) + f"achieved {k}".rjust(12) for k in range(1, len(steps) + 1))
    lines = [head + "error/sigma".rjust(13)]
    for i, name in enumerate(steps[0]["names"]):
        cells = [f"{1e3 * s['predicted'][i]:13.2f}{1e3 * s['achieved'][i]:12.2f}" for s in steps]
        last = steps[-1]["error"][i] / steps[-1]["achieved"][i]
        lines.append(name.ljust(28) + f"{1e3 * steps[0]['wanted'][i]:7.2f}" + "".join(cells) + f"{last:13.2f}")
    ratios = [f"{np.max(s[of] / s['wanted']):.2f}" for s in steps for of in ("predicted", "achieved")]
    cells = "".join(f"{a:>13}{b:>12}" for a, b in zip(ratios[::2], ratios[1::2]))
    return "\n".join([*lines, "largest over wanted".ljust(35) + cells])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        print(table(commission(Path(folder))))
