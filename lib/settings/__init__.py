# SPDX-License-Identifier: GPL-3.0-or-later
"""Every option, declared once, and what is made from the declarations.

The options: reference.py (the reference integrator), comparison.py (the verdict, and all of a comparison), cost.py, audit.py,
commands.py (other commands), common.py (what several share: scene, seed, threads).
The mechanism: units.py says how each kind of value is read, checked and written; declaration.py declares options as fields of a frozen
class; words.py turns settings into command-line words. To add an option, declare it here, and use it where it belongs.
"""
