# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of a measurement.

They show error against seconds on log axes, and where the time of a camera sample goes.
"""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

# Colour by family, for every kind of colour vision (Okabe and Ito); the dash and the marker tell its members apart.
_STYLES: dict[str, tuple[str, str, str]] = {
    "mis": ("#000000", "-", "o"),
    "bounded-mis": ("#000000", "--", "s"),
    "d-cos-mis": ("#000000", ":", "^"),
    "random-mis": ("#7a7a7a", "-", "x"),
    "lights": ("#009e73", "-", "D"),
    "bsdf": ("#0072b2", "-", "o"),
    "bounded": ("#0072b2", "--", "s"),
    "d-cos": ("#0072b2", ":", "^"),
    "cosine": ("#56b4e9", "-", "v"),
    "uniform": ("#56b4e9", "--", "P"),
    "separable": ("#cc79a7", "-", "o"),
    "torrance-sparrow": ("#cc79a7", "--", "s"),
    "light-tracing": ("#cc79a7", "-", "D"),
    "photon-mapping": ("#cc79a7", ":", "v"),
    "metropolis": ("#e69f00", ":", "^"),
    "cycles": ("#d55e00", "-", "o"),
    "cycles-denoised": ("#d55e00", "--", "s"),
    "cycles-user": ("#e69f00", "-", "o"),
    "cycles-user-denoised": ("#e69f00", "--", "s"),
}
_STAGE_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#999999", "#f0e442")
_INK, _LINE = "#1d2127", "#d9dde3"
_FONT: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.size": 9.5,
    "svg.fonttype": "path",
    "axes.edgecolor": "#9aa3ae",
}


def _amount(value: float, _position: int | None = None) -> str:
    return f"{value:.10g}" if value < 1e4 else f"{value:.0e}"


def _some_digits(value: float, _position: int | None = None) -> str:
    """Labels at 2 and 5, for axes that span little more than a decade."""
    digit = round(value / 10.0 ** math.floor(math.log10(value) + 1e-9))
    return _amount(value) if digit in (2, 5) else ""


def _every_digit(value: float, _position: int | None = None) -> str:
    return _amount(value)


def _nothing(_value: float, _position: int | None = None) -> str:
    return ""


def error_figure(figures: dict[str, Any]) -> Figure:
    """Draw the error of one image against seconds.

    Seconds of rendering alone are on the left, those of the whole command on the right. Bars are 95 % intervals. Biased
    ways go on to their floor, dotted, as far as it was found.
    """
    with mpl.rc_context(_FONT):
        figure = Figure(figsize=(13.0, 6.4), layout="constrained", facecolor="white")
        left, right = figure.subplots(1, 2, sharey=True)
        ways = [way for way in figures["ways"] if way["points"]]
        for way in ways:
            _line(left, way, [p["seconds"]["value"] for p in way["points"]])
            _line(right, way, [p["command_seconds"] for p in way["points"]], labelled=False)
        for axes, title in ((left, "Rendering alone"), (right, "The whole command")):
            _dress(axes, title)
        left.set_ylabel("relative RMSE of the image, %")
        _slope(left)
        for way in ways:
            _floor(left, way)
        figure.legend(loc="outside right center", frameon=False, fontsize=8.5, handlelength=3.2, labelspacing=0.7)
    return figure


def _line(axes: Axes, way: dict[str, Any], seconds: list[float], *, labelled: bool = True) -> None:
    colour, dash, marker = _STYLES.get(way["key"], (_INK, "-", "."))
    errors = [p["error"] for p in way["points"]]
    y = 100.0 * np.array([e["value"] for e in errors])
    ends = 100.0 * np.array([[_or(e["low"], e["value"]), _or(e["high"], e["value"])] for e in errors]).T
    bars = np.clip(np.array([y - ends[0], ends[1] - y]), 0.0, None)
    bars[0] = np.minimum(bars[0], 0.999 * y)  # an end at zero has no place on a log axis
    heavy = way["key"] in ("mis", "cycles")
    axes.errorbar(
        seconds,
        y,
        yerr=bars,
        color=colour,
        linestyle=dash,
        marker=marker,
        markersize=5.0 if heavy else 4.0,
        linewidth=2.0 if heavy else 1.2,
        elinewidth=0.8,
        capsize=2.0,
        label=way["label"] if labelled else None,
    )


def _or(value: float | None, other: float) -> float:
    return other if value is None else value


def _dress(axes: Axes, title: str) -> None:
    axes.set(xscale="log", yscale="log", xlabel="seconds")
    axes.set_title(title, fontsize=11.0, loc="left", color=_INK)
    axes.grid(True, which="major", color=_LINE, linewidth=0.8)
    axes.set_axisbelow(True)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(_amount))
        low, high = axis.get_view_interval()
        narrow = _every_digit if high < 5.0 * low else _some_digits if high < 50.0 * low else _nothing
        axis.set_minor_formatter(FuncFormatter(narrow))
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _slope(axes: Axes) -> None:
    """Guides of error falling as 1/sqrt(seconds), through the corners of half decades."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    for k in np.arange(math.floor(math.log10(y0 * math.sqrt(x0))), math.log10(y1 * math.sqrt(x1)) + 0.5, 0.5):
        axes.plot([x0, x1], 10.0**k / np.sqrt([x0, x1]), color=_LINE, linewidth=0.8, linestyle=(0, (6, 4)), zorder=0)
    axes.plot([], [], color="#aab2bd", linewidth=0.8, linestyle=(0, (6, 4)), label=r"$1/\sqrt{N}$")
    axes.set(xlim=(x0, x1), ylim=(y0, y1))


def _floor(axes: Axes, way: dict[str, Any]) -> None:
    """Draw the line from the last point on towards the bias that stays.

    It is sqrt(variance x seconds / s + bias^2), drawn if the interval excludes zero.
    """
    last = way["points"][-1]
    floor = last["squared_bias"]
    if way["bias_kind"] == "none" or floor["low"] is None or floor["low"] <= 0.0:
        return
    x0, x1 = last["seconds"]["value"], axes.get_xlim()[1]
    if x1 <= x0:
        return
    x = np.geomspace(x0, x1, 60)
    y = 100.0 * np.sqrt(last["variance"]["value"] * x0 / x + floor["value"])
    axes.plot(x, y, color=_STYLES.get(way["key"], (_INK, "-", "."))[0], linestyle=(0, (1, 2)), linewidth=1.2)
    axes.set_xlim(right=x1)


def stage_figure(figures: dict[str, Any]) -> Figure:
    """Draw nanoseconds of a thread per camera sample, stage by stage.

    There is a bar for each way that has clocks of its own.
    """
    ways = [way for way in figures["ways"] if way["points"] and len(way["stages"]) > 3]
    names = list(dict.fromkeys(stage["name"] for way in ways for stage in way["stages"]))
    with mpl.rc_context(_FONT):
        figure = Figure(figsize=(13.0, 1.3 + 0.34 * max(len(ways), 1)), layout="constrained", facecolor="white")
        axes = figure.subplots()
        at = np.arange(len(ways))
        start = np.zeros(len(ways))
        for k, name in enumerate(names):
            spent = [sum(s["nanoseconds"] for s in way["stages"] if s["name"] == name) for way in ways]
            hatch = "////" if k >= len(_STAGE_COLOURS) else None
            colour = _STAGE_COLOURS[k % len(_STAGE_COLOURS)]
            axes.barh(at, spent, left=start, color=colour, height=0.7, label=name, hatch=hatch, edgecolor="white")
            start += spent
        axes.set_yticks(at, [way["label"] for way in ways])
        axes.invert_yaxis()
        axes.set_xlabel("nanoseconds of a thread per camera sample")
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        figure.legend(loc="outside right center", frameon=False, fontsize=8.5)
    return figure


def save(figure: Figure, folder: Path, name: str) -> str:
    """Write NAME.png and NAME.svg into `folder`; the SVG's text, without its header."""
    figure.savefig(folder / f"{name}.png", dpi=150)
    text = io.StringIO()
    style: dict[Any, Any] = _FONT | {"svg.hashsalt": name}
    with mpl.rc_context(style):
        figure.savefig(text, format="svg", metadata={"Date": None})
    (folder / f"{name}.svg").write_text(text.getvalue(), encoding="utf-8")
    return text.getvalue()[text.getvalue().index("<svg") :]
