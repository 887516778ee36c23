# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures of a measurement as plain data.

They are cost.json, and cost.csv with a line for each point.
"""

from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ..effects.plan import Plan
from ..files.plain_data import make_plain
from .efficiency import MEASURES, efficiency, ratio, relmse
from .estimates import Estimate, of_mean, of_positive_mean
from .forecast import Forecast, forecast
from .measure import Measured, Measurement, Point
from .models import Form
from .stages import stages
from .verify import Verification
from .ways import Bias

FORMAT, VERSION = "etalon-cost", 1
TARGETS = (0.1, 0.03, 0.01, 0.003, 0.001)
BASELINE = "cycles"


@dataclass(frozen=True)
class Extras:
    """The data beside the measurement.

    They are forms of the model, the scene's plan, targets, the check of a forecast, and the command.
    """

    forms: tuple[Form, ...] = ()
    plan: Plan | None = None
    targets: tuple[float, ...] = TARGETS
    verification: Verification | None = None
    command: str = ""


def error(measured: Measured, point: Point) -> Estimate:
    """Relative RMSE of one image."""
    values = relmse(measured, point)
    estimate = of_positive_mean(values) if measured.way.bias is Bias.NONE else of_mean(values)
    return estimate.map(lambda v: math.sqrt(max(v, 0.0)))


def bias(measured: Measured) -> Estimate:
    """Relative RMS of the bias at the last point.

    It is what is left however often the way is repeated.
    """
    return of_mean(measured.points[-1].column("bias")).map(lambda v: math.sqrt(max(v, 0.0)))


def document(measurement: Measurement, extras: Extras) -> dict[str, Any]:
    """cost.json as a dictionary; numbers that are not finite are None."""
    return make_plain(
        {
            "format": FORMAT,
            "version": VERSION,
            "scene": measurement.scene,
            "size": {"width": measurement.size[0], "height": measurement.size[1]},
            "targets": extras.targets,
            "ways": [_way(measurement, m, extras) for m in measurement.ways],
            "forms": [asdict(form) for form in extras.forms],
            "verification": None if extras.verification is None else asdict(extras.verification),
            "truth": asdict(measurement.truth),
            "pairs": measurement.pairs,
            "stopped": measurement.stopped,
            "started": measurement.started,
            "seconds": measurement.seconds,
            "budget": measurement.budget,
            "versions": measurement.versions,
            "command": extras.command,
        }
    )


def _way(measurement: Measurement, m: Measured, extras: Extras) -> dict[str, Any]:
    found: dict[str, Any] = {
        "key": m.way.key,
        "label": m.way.label,
        "group": m.way.group,
        "bias_kind": m.way.bias,
        "missing": m.missing,
        "settings": m.settings,
        "setup_seconds": m.setup,
        "nonfinite_samples": m.nonfinite,
        "points": [_point(m, point) for point in m.points],
    }
    if not m.points:
        return found
    baseline = measurement[BASELINE] if measurement.has(BASELINE) else None
    return found | {
        "bias": asdict(bias(m)),
        "stages": [asdict(stage) for stage in stages(m, extras.plan)],
        "efficiency": {name: asdict(efficiency(m, name)) for name in MEASURES},
        "ratio_to_cycles": {name: asdict(ratio(m, baseline, name)) for name in MEASURES} if baseline else None,
        "to_error": [_forecast(told) for target in extras.targets if (told := forecast(m, target)) is not None],
    }


def _point(m: Measured, point: Point) -> dict[str, Any]:
    return {
        "samples": point.samples,
        "error": asdict(error(m, point)),
        "relmse": {name: float(relmse(m, point, name).mean()) for name in MEASURES},
        "variance": asdict(of_positive_mean(point.column("variance"))),
        "squared_bias": asdict(of_mean(point.column("bias"))),
        "seconds": asdict(of_positive_mean(point.seconds)),
        "command_seconds": m.setup + float(point.wall.mean()),
        "pairs": [asdict(score) for score in point.scores],
        "replicate_seconds": point.seconds,
        "replicate_wall_seconds": point.wall,
    }


def _forecast(told: Forecast) -> dict[str, Any]:
    return {**asdict(told), "reached": told.reached}


def write_csv(figures: dict[str, Any], path: Path) -> None:
    """One line for each point of each way."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        columns = ["way", "samples", "seconds", "command_seconds", "error", "error_low", "error_high"]
        writer.writerow([*columns, "relmse", "relmse_trimmed", "relmse_median", "variance", "squared_bias"])
        for way in figures["ways"]:
            for p in way["points"]:
                clocks = [p["samples"], p["seconds"]["value"], p["command_seconds"]]
                errors = [p["error"][key] for key in ("value", "low", "high")]
                means = [p["relmse"][name] for name in MEASURES]
                parts = [p["variance"]["value"], p["squared_bias"]["value"]]
                writer.writerow([way["key"], *clocks, *errors, *means, *parts])
