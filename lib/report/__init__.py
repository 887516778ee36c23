# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person reads: HTML, JSON, pictures.

summary.py the verdict in three sentences, words.py its details, document.py and verdict.schema.json all its figures, read.py reads them
back. write.py writes the folder, page.py fills the template report.html. The script of that page is in calculations.js (what needs no
browser), pictures.js, viewer.js (the panes), regions.js (the table) and controls.js; flip.py makes a map for the eye. batch.py and
batch.html are the table of many comparisons.
"""

from .write import write_report

__all__ = ["write_report"]
