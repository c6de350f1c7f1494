"""Mass, centre of mass and inertia of spacecraft and space robots, identified from telemetry.

>>> import poinsot as pn
>>> vehicle = pn.Model.read("data/stsat3/model.toml")
>>> record = pn.Telemetry.read("data/stsat3/multiaxis/telemetry_noisy.csv")
>>> answer = pn.identify(vehicle, record)
>>> answer.status
'converged'
>>> answer.bodies["spacecraft"].inertia_kg_m2.round(2)
array([[13.92,  0.08,  0.13],
       [ 0.08, 16.95,  0.59],
       [ 0.13,  0.59, 19.89]])

Numbers are in SI; names of entries carry their unit. `NOTATION.md` defines frames, points and signs.
"""

import os as _os

from . import _core, dynamics
from ._answer import Answer, Body, Covariance, Direction, Residuals
from ._errors import Explanation, InputError, InternalError, PoinsotError, ResourceError, explain
from ._filter import Filter, FilterAnswer, follow
from ._inertia import Inertia
from ._model import Model
from ._problem import Evaluation, Problem
from ._telemetry import Telemetry
from ._verbs import (
    CampaignResult,
    Document,
    Simulation,
    campaign,
    check,
    compare,
    design,
    export,
    identify,
    inspect,
    methods,
    predict,
    simulate,
    study,
    sweep,
    units,
    validate,
)

__version__: str = _core.version()

# Threads do not survive a fork: the child starts its own.
if hasattr(_os, "register_at_fork"):
    _os.register_at_fork(after_in_child=_core.after_fork)

__all__ = [
    "Answer",
    "Body",
    "CampaignResult",
    "Covariance",
    "Direction",
    "Document",
    "Evaluation",
    "Explanation",
    "Filter",
    "FilterAnswer",
    "Inertia",
    "InputError",
    "InternalError",
    "Model",
    "PoinsotError",
    "Problem",
    "Residuals",
    "ResourceError",
    "Simulation",
    "Telemetry",
    "__version__",
    "campaign",
    "check",
    "compare",
    "design",
    "dynamics",
    "explain",
    "export",
    "follow",
    "identify",
    "inspect",
    "methods",
    "predict",
    "simulate",
    "study",
    "sweep",
    "units",
    "validate",
]
