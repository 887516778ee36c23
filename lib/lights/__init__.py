# SPDX-License-Identifier: GPL-3.0-or-later
"""Samplers of lights, one file per kind of light.

Each samples a direction towards the light, intersects the light with a ray, and returns the density of sampled
directions.

light.py what all offer, build.py from the scene's lights to samplers, selection.py the choice among them; point.py,
sphere.py, spot.py, sun.py; area.py what flat lights share (spread.py, beam.py where the spread is zero), rectangle.py
(spherical_rectangle.py its solid angle), ellipse.py; environment.py the world, sky.py one with suns in it,
triangles.py emissive meshes; cone.py directions in a cone.
"""
