# SPDX-License-Identifier: GPL-3.0-or-later
"""The same scenes under several Blenders: finding these, rendering all in rounds, and what is claimed of each change."""
