# SPDX-License-Identifier: GPL-3.0-or-later
"""One file per kind of light: sample a direction towards it, meet it with a ray, and the density of doing so."""
