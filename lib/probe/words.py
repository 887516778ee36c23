# SPDX-License-Identifier: GPL-3.0-or-later
"""What a probe found: lines for the terminal, and figures as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from ..lights.light import luminance
from ..lights.units import EFFICACY, LightUnits
from ..plural import plural
from .measure import KINDS, ROUNDING, Probe, Reading

_HEADINGS: dict[str, str] = dict(zip(KINDS, ("", "by light pass", "by bounce", "by light"), strict=True))
EFFICACY_NOTE = (
    f"Candela and lumens: {EFFICACY:g} lm for each watt of luminance, as in Blender's glTF exporter. Blender's watts have no spectrum; "
    "1 W of real white light is about 179 lm."
)


def probe_lines(name: str, probe: Probe) -> list[str]:
    """The readings as luminances with one standard error, in a table of four columns."""
    left, top, right, _ = probe.box
    edge = right - left + 1
    where = f"pixel x {left}, y {top}" if edge == 1 else f"{edge} x {edge} pixels from x {left}, y {top}"
    told = f"{plural(probe.replicates, 'replicate')} of {plural(probe.samples, 'sample')} on each side"
    rows = [("luminance, W m-2 sr-1", "reference", "Cycles", "difference")]
    kind: str = KINDS[0]
    for reading in probe.readings:
        if reading.kind != kind:
            kind = reading.kind
            rows.append((_HEADINGS[kind], "", "", ""))
        rows.append((f"  {reading.name}" if _HEADINGS[kind] else reading.name, *_cells(reading)))
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    table = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return [f"{name}, {where}: {told}, {probe.seconds:.0f} s; ± is one standard error", *table]


def _cells(reading: Reading) -> tuple[str, str, str]:
    sides = (reading.reference, reading.reference_error), (reading.cycles, reading.cycles_error)
    (mine, mine_error), (theirs, theirs_error) = (_with_error(mean, error) for mean, error in sides)
    if mine == 0.0:
        difference = "same" if theirs == 0.0 else "only in Cycles"
    else:
        error = float(np.hypot(mine_error, theirs_error)) / abs(mine)
        difference = f"{100.0 * (theirs - mine) / abs(mine):+.2f} % ± {100.0 * error:.2f} %"
    return f"{mine:.4g} ± {mine_error:.1g}", f"{theirs:.4g} ± {theirs_error:.1g}", difference


def _luminance(color: np.ndarray) -> float:
    return float(luminance(color[:, None])[0])


def _with_error(mean: np.ndarray, error: np.ndarray) -> tuple[float, float]:
    """A luminance and its standard error.

    The error is that of channels which share their noise, which is the most that it can be.
    """
    value, spread = _luminance(mean), _luminance(np.abs(error))
    return value, spread if spread > ROUNDING * abs(value) else 0.0


def light_lines(lights: Sequence[LightUnits]) -> list[str]:
    """Every lamp in all units that it has, and what these rest on."""
    if not lights:
        return ["No lamp: all light comes from objects or the world."]
    return ["Lamps, as Blender means their Power", *(f"  {_light_line(light)}" for light in lights), EFFICACY_NOTE]


def _light_line(light: LightUnits) -> str:
    power = _luminance(light.power)
    if light.kind == "sun":
        return f"{light.name}: sun, {power:.4g} W/m2 on a plane that faces it, {light.lux:.4g} lx"
    told = [f"{light.name}: {light.kind}, {power:.4g} W"]
    if light.kind == "spot":
        passes = "an unknown part" if light.flux is None else f"{_luminance(light.flux):.4g} W"
        told.append(f"of which the cone lets out {passes}")
    if light.intensity is not None:
        told.append(f"{_luminance(light.intensity):.4g} W/sr along its axis, {light.candela:.4g} cd")
    if light.lumens is not None:
        told.append(f"{light.lumens:.4g} lm")
    if light.exitance is not None:
        told.append(f"its surface {_luminance(light.exitance):.4g} W/m2")
    return ", ".join(told)


def probe_figures(probe: Probe, lights: Sequence[LightUnits]) -> dict[str, Any]:
    """All figures as plain data, colours as [R, G, B]."""
    units = ("lumens", "candela", "lux")
    listed = [asdict(light) | {unit: getattr(light, unit) for unit in units} for light in lights]
    return asdict(probe) | {"lights": listed, "lumens_per_watt": EFFICACY}
