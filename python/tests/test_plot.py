"""Figures: drawn without a screen, for determined and undetermined answers."""

import pickle

import pytest

import poinsot as pn

pytestmark = pytest.mark.extra

STSAT3 = "data/stsat3/model.toml"


@pytest.fixture(scope="module")
def answers():
    pytest.importorskip("matplotlib")
    return [pn.identify(STSAT3, f"data/stsat3/{run}/telemetry_noisy.csv") for run in ("multiaxis", "paper")]


@pytest.mark.parametrize("kind", ["tensor", "ellipsoid", "residuals", "undetermined", "all"])
def test_exact_every_kind_is_drawn(answers, kind, tmp_path):
    for k, answer in enumerate(answers):
        if kind == "ellipsoid" and not answer.bodies["spacecraft"].determined:
            with pytest.raises(pn.InputError):
                answer.plot(kind)
            continue
        answer.plot(kind).savefig(tmp_path / f"{k}.png")
        assert (tmp_path / f"{k}.png").stat().st_size > 3_000


def test_exact_a_notebook_shows_a_figure(answers):
    """As SVG of at most 139 KB, the same at every run; without pyplot its size alone was shown."""
    for kind in ("tensor", "residuals"):
        shown = [answers[0].plot(kind)._repr_svg_() for _ in range(2)]
        assert shown[0] == shown[1] and "<svg" in shown[0] and len(shown[0]) < 200_000
    assert "time (s)" in shown[0]
    assert len(pickle.dumps(answers[0].plot())) > 1000


def test_unit_labels_of_directions_fit_into_the_figure(answers, recwarn):
    """The layout of matplotlib gave up, by a warning, and cut the names off."""
    figure = answers[1].plot("undetermined")
    figure.draw_without_rendering()
    assert not [str(w.message) for w in recwarn]
    labels = [label.get_window_extent() for label in (*figure.axes[0].get_xticklabels(), *figure.axes[0].get_yticklabels())]
    assert len(labels) == 6 + 3 and all(figure.bbox.contains(*corner) for label in labels for corner in (label.min, label.max))


def test_exact_compare_marks_what_is_undetermined(answers):
    from poinsot import plot

    figure = plot.compare({"six slews": answers[0], "one slew": answers[1]})
    words = [t.get_text() for panel in figure.axes for t in panel.texts]
    assert words.count("undetermined") == sum(answers[1].bodies["spacecraft"].source[f"inertia_kg_m2.{e}"] is None for e in ("xx", "yy", "zz", "xy", "xz", "yz"))
    with pytest.raises(pn.InputError):
        answers[0].plot("pie")
