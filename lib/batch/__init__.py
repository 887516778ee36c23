# SPDX-License-Identifier: GPL-3.0-or-later
"""Many comparisons: plan, journal, and one process for each."""
