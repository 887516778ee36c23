# SPDX-License-Identifier: GPL-3.0-or-later
"""Files and folders of results, written beside their place and renamed as a whole."""
