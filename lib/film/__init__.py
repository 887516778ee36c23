# SPDX-License-Identifier: GPL-3.0-or-later
"""Images and their moments over replicates; EXR and PNG in and out.

rendering.py one replicate as a renderer gives it, moments.py count, mean and squared deviations, film.py one side's image,
windows.py parts of an image, regions.py blocks, materials and objects as weighted means, exr.py and pictures.py files and views.
"""
