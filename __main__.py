# SPDX-License-Identifier: GPL-3.0-or-later
"""`python -m etalon` equals the command `etalon`."""

import sys

from .addon.command.supervised import main

if __name__ == "__main__":
    sys.exit(main())
