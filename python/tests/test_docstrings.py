"""Every public name says what it is and what its arguments are."""

import inspect

import pytest

import poinsot as pn
from poinsot import adapters, dynamics, plot


def _public():
    """Functions, classes, methods and properties by their path."""
    for module in (pn, adapters, dynamics, plot):
        here = module.__name__
        own = [n for n, v in vars(module).items() if getattr(v, "__module__", "") == here]
        names = getattr(module, "__all__", own)
        for name in names:
            value = getattr(module, name)
            if name.startswith("_") or not callable(value):
                continue
            yield f"{here}.{name}", value
            members = vars(value).items() if inspect.isclass(value) else []
            for member, inner in members:
                inner = inner.fget if isinstance(inner, property) else getattr(inner, "__func__", inner)
                if not member.startswith("_") and inspect.isfunction(inner):
                    yield f"{here}.{name}.{member}", inner


@pytest.mark.parametrize("value", [pytest.param(v, id=path) for path, v in _public()])
def test_exact_every_public_name_is_documented(value):
    text = inspect.getdoc(value) or ""
    assert text.strip(), "no docstring"
    if inspect.isfunction(value):
        taken = [p.lstrip("*") for p in inspect.signature(value).parameters if p not in ("self", "cls")]
        section = text.partition("Parameters\n----------\n")[2]
        # A parameter stands at the beginning of a line, alone or with others.
        listed = {n.strip(" *") for line in section.splitlines() if not line.startswith(" ") for n in line.split(",")}
        assert set(taken) <= listed, f"{set(taken) - listed} not under Parameters"
