# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person reads: HTML, JSON, pictures.

summary.py the verdict in three sentences, words.py its details, document.py and verdict.schema.json all its figures, read.py reads them
back, flip.py a map for the eye, write.py the folder, report.html with report.js the page; batch.py and batch.html the table of many
comparisons.
"""

from .write import write_report

__all__ = ["write_report"]
