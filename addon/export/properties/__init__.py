# SPDX-License-Identifier: GPL-3.0-or-later
"""Which properties of Blender's structs the export knows.

known.py what a table of a struct says, of_blender.py and of_cycles.py the tables, fresh_structs.py structs as Blender makes them,
declared.py the refusal of what no table knows.
"""
