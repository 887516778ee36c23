# SPDX-License-Identifier: GPL-3.0-or-later
"""From two films to EQUIVALENT, DIFFERENT or UNDECIDED, region by region."""
