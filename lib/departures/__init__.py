# SPDX-License-Identifier: GPL-3.0-or-later
"""Known departures of Cycles from the model, by name.

Each has a switch that makes the reference depart likewise.

catalogue.py the list; scene.py the departures that are a change of the scene, closures.py and light_below.py those in what a
surface does. The switches are asked when a scene is made ready, never along a path; lib/comparison/departures.py measures how
much they change an image, and lib/verdict/attribution.py asks which of them explain a difference.
"""
