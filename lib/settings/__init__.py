# SPDX-License-Identifier: GPL-3.0-or-later
"""How an option is declared, once, so that everything else about it can be made from the declaration.

units.py says how each kind of value is read, checked and written; declaration.py declares options as the fields of a frozen class;
common.py holds the options that several commands share; words.py turns settings into command-line words and back.
The options themselves are declared beside what they are for, in the files called options.py.
"""
