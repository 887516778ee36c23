# SPDX-License-Identifier: GPL-3.0-or-later
"""What accuracy costs in time: error against seconds for every way to render a scene.

Forecasts follow from it. ways.py defines what is measured, yardstick.py the error of images, measure.py the measuring,
estimates.py and efficiency.py what follows with its interval, forecast.py the seconds that an error takes and verify.py
their test, stages.py where the time goes, models.py what approximations of the model leave and save; document.py,
plots.py, write.py and cost.html what a person reads.
"""
