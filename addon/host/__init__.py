# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender that Étalon runs in.

This is loading it, its release, its messages, and the frame it renders.
"""
