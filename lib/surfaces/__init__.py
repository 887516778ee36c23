# SPDX-License-Identifier: GPL-3.0-or-later
"""What a ray meets: surface quantities at hit points, and the lobes built from materials there."""
