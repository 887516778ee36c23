# SPDX-License-Identifier: GPL-3.0-or-later
"""Progressive photon mapping: an estimator with a stated bias.

The bias falls with the radius.
"""
