# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop of a comparison: compare.py, and what it is put together from.

run.py renders against the clock, meter.py time and limits of a comparison, size.py how large an image, caustics.py light that is hard to
find, pilot.py the first look and what it lays out, sides.py one renderer's part, course.py and focus.py where sampling goes on,
attainable.py and pace.py what the time that is left allows, search.py attribution beside it, departures.py what departures change,
comparison.py all that is found.
"""
