# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time, and forecasts."""
