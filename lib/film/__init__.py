# SPDX-License-Identifier: GPL-3.0-or-later
"""Images and their moments over replicates; EXR and PNG in and out."""
