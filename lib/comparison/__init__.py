# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop of a comparison: compare.py, and what it is put together from.

meter.py time and limits, pilot.py samples per replicate, sides.py one renderer's part,
focus.py where sampling goes on, search.py attribution beside it, departures.py what departures change.
"""
