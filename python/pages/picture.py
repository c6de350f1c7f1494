"""The picture of the README, drawn by figures.py: what two manoeuvres of one satellite tell about its inertia tensor.

Runs `identify` on data/stsat3/paper (one slew) and data/stsat3/multiaxis (six slews), and compares
the answers with truth.json.
"""

import json
import math
import sys
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = "data/stsat3"
ENTRIES = ["xx", "yy", "zz", "xy", "xz", "yz"]
RUNS = [("paper", "One slew"), ("multiaxis", "Six slews about different axes")]

WIDTH = 960
PANEL_WIDTH, PANEL_TOP, ROW = 400, 136, 36
LEFT = [64, 528]
DECADES = (-6, 1)  # of the horizontal axis, kg m2
INK, FAINT, GRID = "#1f2933", "#52606d", "#d9dee4"
LANE, SIGMA, HIT, START = "#eef1f4", "#9ec5e8", "#0b4f8a", "#b3541e"


def rows_of(answer, truth):
    """One row per tensor entry, then one per determined combination where single entries are open."""
    inertia = answer["bodies"]["spacecraft"]["inertia_kg_m2"]
    rows = []
    for e in ENTRIES:
        rows.append(
            {
                "label": [("I", e)],
                "sigma": inertia[e]["sigma"],
                "error": None if inertia[e]["value"] is None else abs(inertia[e]["value"] - truth[e]),
                "start": abs(inertia[e]["nominal"] - truth[e]),
            }
        )
    if any(row["error"] is None for row in rows):
        for c in answer["identifiability"]["identifiable"]:
            parts = [(name.rsplit(".", 1)[1], k) for name, k in c["coefficients"].items()]
            true_value = sum(k * truth[e] for e, k in parts)
            start = sum(k * inertia[e]["nominal"] for e, k in parts)
            said = sorted((p for p in parts if abs(p[1]) >= 0.01), key=lambda p: p[1] != 1.0)
            rows.append(
                {
                    "label": [(combination_head(i, k), e) for i, (e, k) in enumerate(said)],
                    "sigma": c["sigma"],
                    "error": abs(c["value"] - true_value),
                    "start": abs(start - true_value),
                }
            )
    return rows


def combination_head(i, k):
    sign = "" if i == 0 and k > 0 else (" + " if k > 0 else " \u2212 ")
    size = "" if abs(abs(k) - 1.0) < 0.005 else f"{abs(k):.2f}\u2009"
    return f"{sign}{size}I"


def x_of(left, value):
    low, high = DECADES
    place = (math.log10(max(value, 10.0**low)) - low) / (high - low)
    return round(left + PANEL_WIDTH * min(place, 1.0), 1)


def text(x, y, content, size=13, fill=INK, anchor="start", weight="normal"):
    return (
        f'<text x="{x}" y="{y}" font-size="{size}" fill="{fill}" text-anchor="{anchor}" '
        f'font-weight="{weight}">{content}</text>'
    )


def label(parts):
    return "".join(
        f'{escape(head)}<tspan font-size="9.5" dy="3">{escape(e)}</tspan><tspan dy="-3">\u200b</tspan>'
        for head, e in parts
    )


def diamond(x, y):
    return (
        f'<path d="M{x} {y - 5.5}l5.5 5.5l-5.5 5.5l-5.5 -5.5z" fill="white" stroke="{START}" '
        'stroke-width="1.6"/>'
    )


def dot(x, y):
    return f'<circle cx="{x}" cy="{y}" r="4.6" fill="{HIT}"/>'


def axis(left, bottom):
    """Grid, ticks and caption of one panel."""
    out = []
    for decade in range(DECADES[0], DECADES[1] + 1):
        x = x_of(left, 10.0**decade)
        out.append(f'<path d="M{x} {PANEL_TOP - 8}V{bottom}" stroke="{GRID}" stroke-width="1"/>')
        exponent = str(decade).replace("-", "\u2212")
        power = f'10<tspan font-size="9" dy="-5">{exponent}</tspan>'
        name = {0: "1", 1: "10"}.get(decade, power)
        out.append(text(x, bottom + 18, name, 12, FAINT, "middle"))
    out.append(text(left + PANEL_WIDTH / 2, bottom + 38, "distance from the truth, kg\u2009m\u00b2", 12, FAINT, "middle"))
    return out


def panel(left, answer, rows, title, bottom):
    start, end = answer["inputs"][0]["time_s"]
    rank, asked = answer["identifiability"]["rank"], answer["identifiability"]["parameters"]
    head = f"{title}, {end - start:.0f} s"
    verdict = f"{rank} of {asked} combinations determined"
    out = [text(left, PANEL_TOP - 40, escape(head), 15, weight="bold")]
    out.append(text(left, PANEL_TOP - 21, f"{verdict} (status: {answer['status']})", 12.5, FAINT))
    lanes = []
    y = PANEL_TOP + 14
    for at, row in enumerate(rows):
        if at == len(ENTRIES):
            y += 34
            lanes.append(text(left, y - 32, "determined instead (terms below 0.01 left out)", 12.5, FAINT))
        if at < len(ENTRIES):
            lanes.append(text(left - 8, y + 4, label(row["label"]), 13, anchor="end"))
        else:
            lanes.append(text(left, y - 11, label(row["label"]), 12.5))
        lanes += lane(left, y, row)
        y += ROW if at < len(ENTRIES) else ROW + 4
    return out + axis(left, bottom) + lanes


def lane(left, y, row):
    shape = f'x="{left}" y="{y - 6}" height="12" rx="2"'
    if row["error"] is None:
        return [
            f'<rect {shape} width="{PANEL_WIDTH}" fill="url(#open)"/>',
            f'<rect x="{left + 34}" y="{y - 6}" width="220" height="12" fill="{LANE}"/>',
            text(left + PANEL_WIDTH * 0.36, y + 4, "not identifiable: no number given", 12, FAINT, "middle"),
            diamond(x_of(left, row["start"]), y),
        ]
    end = x_of(left, 1.96 * row["sigma"])
    return [
        f'<rect {shape} width="{PANEL_WIDTH}" fill="{LANE}"/>',
        f'<rect {shape} width="{round(end - left, 1)}" fill="{SIGMA}"/>',
        diamond(x_of(left, row["start"]), y),
        dot(x_of(left, row["error"]), y),
    ]


def legend(left, top):
    rows = [
        (diamond(left + 26, top), "nominal value in the model file, before"),
        (dot(left + 26, top + 26), "answer of poinsot identify"),
        (
            f'<rect x="{left}" y="{top + 46}" width="52" height="12" rx="2" fill="{SIGMA}"/>',
            "stated 95 % interval (1.96 sigma)",
        ),
    ]
    out = []
    for k, (mark, words) in enumerate(rows):
        out += [mark, text(left + 66, top + 4 + 26 * k, words, 12.5, FAINT)]
    return out


def draw(answers, truth):
    tables = [rows_of(answer, truth) for answer in answers]
    methods = " and ".join(sorted({a["method"].replace("_", " ") for a in answers}))
    bottoms = [bottom_of(rows) for rows in tables]
    height = max(bottoms) + 56
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" '
        f'height="{height}" font-family="Helvetica, Arial, \'DejaVu Sans\', sans-serif">',
        "<title>What one slew and what six slews tell about the inertia tensor of STSAT-3</title>",
        '<defs><pattern id="open" width="8" height="8" patternUnits="userSpaceOnUse" '
        f'patternTransform="rotate(45)"><rect width="8" height="8" fill="{LANE}"/>'
        f'<path d="M0 0V8" stroke="{GRID}" stroke-width="3"/></pattern></defs>',
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
        text(LEFT[0] - 40, 34, "One satellite, two manoeuvres: what each tells about its inertia tensor", 18, weight="bold"),
        text(
            LEFT[0] - 40,
            55,
            f"STSAT-3, simulated gyro, star tracker and wheel speeds with noise; method: {escape(methods)}",
            12.5,
            FAINT,
        ),
    ]
    for left, answer, rows, (_, title), bottom in zip(LEFT, answers, tables, RUNS, bottoms):
        parts += panel(left, answer, rows, title, bottom)
    parts += legend(LEFT[1], bottoms[1] + 74)
    return "\n".join([*parts, "</svg>"]) + "\n"


def bottom_of(rows):
    extra = len(rows) - len(ENTRIES)
    return PANEL_TOP + len(ENTRIES) * ROW + (34 + extra * (ROW + 4) if extra else 0)


def picture(runs):
    """The picture, from the answers of the program to both runs."""
    answers = [
        runs.json("identify", "--model", f"{EXAMPLE}/model.toml", "--telemetry", f"{EXAMPLE}/{run}/telemetry_noisy.csv", "--relative-accuracy", "0.5") for run, _ in RUNS
    ]
    truths = [json.loads((ROOT / EXAMPLE / run / "truth.json").read_text()) for run, _ in RUNS]
    bodies = [truth["bodies"]["spacecraft"]["inertia_kg_m2"]["value"] for truth in truths]
    if bodies[0] != bodies[1]:
        sys.exit("picture.py: the two runs have different truths")
    return draw(answers, bodies[0])
