# SPDX-License-Identifier: GPL-3.0-or-later
"""The same scenes under several Blenders.

The package finds the Blenders, renders all in rounds, and judges each change.
"""
