# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of what the export reads: tables of those that are known, and the refusal of all others."""
