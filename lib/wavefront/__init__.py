# SPDX-License-Identifier: GPL-3.0-or-later
"""The path integrator: one file per stage, the loop over the stages, tiles and threads.

Stages: camera rays, intersect, shade, direct light.
"""
