# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: arguments, one function per command, and the terminal."""
