# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene check in words, for the terminal: of a plan and of a comparison alike."""

from __future__ import annotations

from collections.abc import Sequence

from ..scene.findings import Finding


def scene_check_lines(findings: Sequence[Finding]) -> list[str]:
    """A heading, and two lines for each finding; empty without findings.

    The first line is what was found, the second what it does to the comparison and the remedy.
    """
    if not findings:
        return []
    lines = ["scene check"]
    for finding in findings:
        lines += [f"  {finding.check}: {finding.what}", f"    {finding.effect} {finding.remedy}"]
    return lines
