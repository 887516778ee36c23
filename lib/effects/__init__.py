# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue of effects, and the plan: what this scene calls for, and why."""
