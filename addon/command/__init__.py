# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line.

cli.py runs a command and turns errors into one line; table.py lists the commands; arguments.py makes their arguments from declared
options; the file of each command has a function `run`. console.py is the terminal, opening.py opens the scene.
"""
