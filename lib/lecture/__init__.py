# SPDX-License-Identifier: GPL-3.0-or-later
"""The page that `etalon illustrate` makes: what the slides of the lecture show, computed."""
