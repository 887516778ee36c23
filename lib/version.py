# SPDX-License-Identifier: GPL-3.0-or-later
"""The version of Étalon, where everything can read it without importing anything else."""

VERSION = "0.2.0"
