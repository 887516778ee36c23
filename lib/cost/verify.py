# SPDX-License-Identifier: GPL-3.0-or-later
"""A test of a forecast.

The way that it calls cheapest is rendered, and its time and error are compared with the forecast.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from ..film.film import finite_or_nan
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import VERIFICATION
from .forecast import Forecast, forecast, found_floor
from .measure import Measurement
from .ways import Bias


@dataclass(frozen=True)
class Verification:
    """The forecast for the way `key`, and what was measured.

    Measured are the mean `seconds` of two renders of `samples`, and the relative RMSE of one. `to_target` are the
    seconds that the target would have taken, with the variance falling as 1/N between the error that was reached and
    the target.
    """

    key: str
    label: str
    forecast: Forecast
    samples: int
    seconds: float
    whole: float
    error: float
    to_target: float

    @property
    def held(self) -> bool:
        """Whether the seconds lie in the forecast's interval."""
        return self.forecast.seconds.low <= self.seconds <= self.forecast.seconds.high


def cheapest(measurement: Measurement, target: float) -> tuple[str, Forecast] | None:
    """The way with the least forecast seconds of rendering.

    Ways with other models are left out. None where no way reaches the target.
    """
    told = {m.way.key: forecast(m, target) for m in measurement.ways if m.points and m.way.group != "model"}
    reached = {key: f for key, f in told.items() if f is not None and f.reached}
    if not reached:
        return None
    key = min(reached, key=lambda k: reached[k].seconds.median)
    return key, reached[key]


def verify(
    measurement: Measurement,
    target: float,
    progress: Progress = NO_PROGRESS,
) -> Verification | None:
    """Run the cheapest way to `target` twice.

    The difference of the two gives the variance, the truth of the pilots the bias. None where no way reaches the
    target; raises Cancelled when asked to stop.
    """
    found = cheapest(measurement, target)
    if found is None:
        return None
    key, told = found
    measured = measurement[key]
    renderer = measured.way.make()
    renderer.render(VERIFICATION.number(0), 1, progress.silent)
    samples = int(told.samples.median)
    images, seconds, walls = [], [], []
    for k in range(2):
        start = time.monotonic()
        rendering = renderer.render(VERIFICATION.number(1 + k), samples, progress.within(k / 2, (k + 1) / 2))
        walls.append(time.monotonic() - start)
        seconds.append(rendering.seconds)
        images.append(finite_or_nan(rendering, measurement.yardstick.excluded.shape))
    score = measurement.yardstick.score(images[0], images[1], 0)
    floor = max(score.bias, 0.0) if measured.way.bias is Bias.UNKNOWN else found_floor(measured)
    allowed = target**2 - floor
    mean = sum(seconds) / 2
    return Verification(
        key,
        measured.way.label,
        told,
        samples,
        mean,
        measured.setup + sum(walls) / 2,
        math.sqrt(score.variance + floor),
        mean * score.variance / allowed if allowed > 0.0 else math.inf,
    )
