# SPDX-License-Identifier: GPL-3.0-or-later
"""Where Cycles departs from the model, each by name, with a switch that makes the reference depart likewise.

catalogue.py the list; scene.py the departures that are a change of the scene, closures.py those in what a surface does.
The switches are asked when a scene is made ready, never along a path; lib/comparison/departures.py measures how much they change an
image, and lib/verdict/attribution.py asks which of them explain a difference.
"""
