# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference alone, by path tracing or by light tracing, as the options say."""
