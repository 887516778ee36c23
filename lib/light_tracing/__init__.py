# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing: paths that start at the lights and are connected to the camera.

Veach 1997, chapters 4, 8 and 10.

`render.py` renders whole images by it; `scouting.py` looks for caustics, which paths from the camera can hardly find.
"""
