# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person reads: HTML, JSON, pictures."""
