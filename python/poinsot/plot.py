"""Figures of answers, by matplotlib (``pip install 'poinsot[plot]'``). Every function returns a figure."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ._errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ELEMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
# Points of a meridian of an ellipsoid: smooth at the size of a figure.
_MERIDIAN = 40
# Width of a character of a label, at 10 points, in inches.
_CHARACTER_INCH = 0.09
# Half-width of an interval of 95 %, in standard deviations.
_INTERVAL = 1.96


class _Drawn(Protocol):
    """What a figure needs of a :class:`poinsot.Answer`, which calls this module and so is not imported by it."""

    @property
    def bodies(self) -> Mapping[str, Any]: ...

    @property
    def predictions(self) -> Sequence[Any]: ...

    @property
    def undetermined(self) -> Sequence[Any]: ...

    def residuals(self, sensor: str, segment: int = 0) -> Any: ...


def _figure(rows: int = 1, columns: int = 1, width: float = 4.0, height: float = 3.0, **options: Any) -> tuple[Figure, Any]:
    try:
        import matplotlib.figure
    except ImportError:
        raise InputError("E0001 plot: matplotlib is missing; pip install 'poinsot[plot]'") from None
    figure = matplotlib.figure.Figure(figsize=(width * columns, height * rows), layout="constrained")
    # A notebook asks for this method; the figure's own needs pyplot.
    setattr(figure, "_repr_svg_", partial(_svg, figure))
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def _svg(figure: Figure) -> str:
    """The figure as SVG with text as text; the same bytes at every run."""
    import matplotlib

    file = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": "poinsot", "font.sans-serif": ["DejaVu Sans"]}):
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    return "\n".join(line.rstrip() for line in file.getvalue().splitlines()) + "\n"


def _body(answer: _Drawn, body: str | None) -> Any:
    """The body asked for, else the first of which something was unknown."""
    if body is not None:
        if body not in answer.bodies:
            raise InputError(f"E0001 body '{body}': there is no such body; use one of {', '.join(answer.bodies)}")
        return answer.bodies[body]
    asked = [b for b in answer.bodies.values() if any(s != "known" for s in b.source.values())]
    return (asked or list(answer.bodies.values()))[0]


def tensor(answer: _Drawn, body: str | None = None) -> Figure:
    """Draw the elements of an inertia tensor with their intervals of 95 % beside the model's.

    Parameters
    ----------
    answer
        The answer.
    body
        Name of the body; the first unknown one by default. Undetermined elements are marked, not drawn.
    """
    return compare({"estimate": answer}, body)


def compare(answers: Mapping[str, _Drawn] | Sequence[_Drawn], body: str | None = None) -> Figure:
    """Draw the tensor elements of several answers side by side, relative to the model's.

    Parameters
    ----------
    answers
        Answers by name, or in order.
    body
        Name of the body; the first unknown one by default.
    """
    named = dict(answers) if isinstance(answers, Mapping) else {f"answer {k + 1}": a for k, a in enumerate(answers)}
    if not named:
        raise InputError("E0001 answers: no answer; give at least one")
    figure, axes = _figure(1, 6, width=1.8, height=2.6)
    for panel, element in zip(axes[0], _ELEMENTS):
        i, j = "xyz".index(element[0]), "xyz".index(element[1])
        for k, (name, answer) in enumerate(named.items()):
            found = _body(answer, body)
            value, sigma = found.inertia_kg_m2[i, j], found.inertia_sigma_kg_m2[i, j]
            if np.isnan(value):
                panel.text(k, 0.5, "undetermined", rotation=90, ha="center", va="center", transform=panel.get_xaxis_transform())
            else:
                panel.errorbar([k], [value], yerr=[_INTERVAL * sigma], fmt="o", capsize=4, label=name)
            panel.axhline(found.nominal[f"inertia_kg_m2.{element}"], color="0.6", linestyle=":", linewidth=1)
        panel.set_xlim(-0.6, len(named) - 0.4)
        panel.set_xticks(range(len(named)), list(named), rotation=45, ha="right")
        panel.set_title(f"$I_{{{element}}}$ (kg m²)", fontsize="medium")
    figure.suptitle("Inertia about the mass centre, 95 % intervals; dotted: model")
    return figure


def ellipsoid(answer: _Drawn, body: str | None = None) -> Figure:
    """Draw the ellipsoid of gyration of a body: semi-axes are the radii of gyration of equivalent mass planes.

    Parameters
    ----------
    answer, body
        As of :func:`tensor`.
    """
    found = _body(answer, body)
    if not found.determined:
        raise InputError(f"E0001 body '{found.name}': not all of its numbers are determined; use plot('undetermined')")
    moments, axes = np.linalg.eigh(found.inertia_kg_m2)
    second = np.clip(0.5 * moments.sum() - moments, 0.0, None)
    radii = np.sqrt(second / found.mass_kg)
    figure, _ = _figure(width=4.0, height=4.0)
    figure.clear()
    panel: Any = figure.add_subplot(projection="3d")
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * _MERIDIAN), np.linspace(0, np.pi, _MERIDIAN))
    sphere = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
    points = found.com_m[:, None, None] + np.einsum("ij,j,jkl->ikl", axes, radii, sphere)
    panel.plot_wireframe(*points, linewidth=0.4, rstride=3, cstride=5)
    for k in range(3):
        ends = found.com_m + np.outer([-1.0, 1.0], radii[k] * axes[:, k])
        panel.plot(*ends.T)
    panel.set_box_aspect(np.ptp(points.reshape(3, -1), axis=1))
    panel.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)", title=f"{found.name}: ellipsoid of gyration")
    return figure


def residuals(answer: _Drawn, sensor: str | None = None, segment: int = 0) -> Figure:
    """Draw measured less predicted of every sensor, or of one, over time.

    Parameters
    ----------
    answer
        The answer.
    sensor
        As of :meth:`poinsot.Answer.residuals`; all by default.
    segment
        Index of the segment.
    """
    names = [sensor] if sensor is not None else list(dict.fromkeys(r.sensor for r in answer.predictions))
    if not names:
        raise InputError("E0001 answer: it holds no residuals; the fit was rejected before it had any")
    figure, axes = _figure(len(names), 1, width=8.0, height=2.0, sharex=True)
    for panel, name in zip(axes[:, 0], names):
        found = answer.residuals(name, segment)
        # Thousands of points are pixels in an SVG or PDF too.
        panel.plot(found.time_s, found.residual, ".", markersize=1.5, rasterized=True)
        panel.set(ylabel=f"{name} ({found.residual_unit})")
        panel.axhline(0.0, color="0.6", linewidth=0.8)
    axes[-1, 0].set(xlabel="time (s)")
    return figure


def undetermined(answer: _Drawn) -> Figure:
    """Draw the coefficients of every direction that the data do not determine.

    Parameters
    ----------
    answer
        The answer.
    """
    directions = answer.undetermined
    names = list(dict.fromkeys(name for d in directions for name in d.coefficients))
    # Names stand below their columns, directions beside their rows and before the colour bar.
    below = _CHARACTER_INCH * max((len(name) for name in names), default=0)
    figure, axes = _figure(1, 1, width=max(4.0, 0.35 * len(names) + 2.5), height=0.35 * max(3, len(directions)) + 0.5 + below)
    panel = axes[0, 0]
    if not directions:
        panel.text(0.5, 0.5, "every direction is determined", ha="center", va="center")
        panel.set_axis_off()
        return figure
    matrix = np.array([[d.coefficients.get(name, 0.0) for name in names] for d in directions])
    matrix /= np.abs(matrix).max(axis=1, keepdims=True)
    image = panel.imshow(matrix, cmap="RdBu", vmin=-1, vmax=1, aspect="auto")
    panel.set_xticks(range(len(names)), names, rotation=90)
    panel.set_yticks(range(len(directions)), [f"direction {k + 1}" for k in range(len(directions))])
    figure.colorbar(image, label="coefficient, relative")
    return figure


def draw(answer: _Drawn, kind: str = "all", **options: Any) -> Figure:
    """Draw a kind of figure.

    Parameters
    ----------
    answer
        The answer.
    kind, **options
        As in :meth:`poinsot.Answer.plot`.
    """
    kinds: dict[str, Callable[..., Figure]] = {"tensor": tensor, "ellipsoid": ellipsoid, "residuals": residuals, "undetermined": undetermined}
    if kind in kinds:
        return kinds[kind](answer, **options)
    if kind != "all":
        raise InputError(f"E0001 kind '{kind}': there is no such figure; use one of {', '.join(kinds)}, all")
    # What says most: the tensor where some of it is determined, else why not.
    found = _body(answer, options.get("body"))
    return tensor(answer, found.name) if not np.isnan(found.inertia_kg_m2).all() else undetermined(answer)
