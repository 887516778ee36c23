# SPDX-License-Identifier: GPL-3.0-or-later
"""What each render setting costs: one renderer against itself, a setting at a time.

setting.py a setting to measure, paired.py claims and intervals for two images made from the same random numbers, measure.py rounds of
renders within a budget, document.py and audit.schema.json all figures, write.py and audit.html the folder.
"""
