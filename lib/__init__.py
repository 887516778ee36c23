# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that computes light; nothing here imports bpy.

Data walks one way: Scene -> Plan -> wavefront -> Film -> Verdict -> report.
"""
