# SPDX-License-Identifier: GPL-3.0-or-later
"""A few pixels of an image on both sides, taken apart by light pass, bounce and light."""
