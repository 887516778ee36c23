# SPDX-License-Identifier: GPL-3.0-or-later
"""Light inside of media: phase functions, coefficients, free paths."""
