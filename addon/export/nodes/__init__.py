# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of node trees: materials, worlds and values become lobes and expressions."""
