# SPDX-License-Identifier: GPL-3.0-or-later
"""Work on several machines by Dask.

A scheduler hands calls to workers, which get the files that they lack by content.
"""
