# SPDX-License-Identifier: GPL-3.0-or-later
"""The Blender that Étalon runs in: loading it, its release, its messages, the frame it renders."""
