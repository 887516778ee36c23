# SPDX-License-Identifier: GPL-3.0-or-later
"""One file per stage of the path integrator: camera rays, intersect, shade, direct light; the loop; tiles and threads."""
