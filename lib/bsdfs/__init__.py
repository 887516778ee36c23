# SPDX-License-Identifier: GPL-3.0-or-later
"""Closures in the local frame, +z the shading normal on the viewer's side.

A lobe is made for the `wo` of some points and then asked three things:
`evaluate(wi)` -> f |cos theta_i|, (3, n), and the density of its own sampling, per steradian of wi, (n,);
`sample(u1, u2)` -> wi, weight = f |cos| / pdf, (3, n), pdf, which is 0 where the sample is rejected (it ended on the wrong side);
`part(index)` -> the same lobe at fewer points.
`lobe.py` has the base classes: `Lobe`, `DeltaLobe`, and `Wrapper` for lobes that do something to another one.
A `delta` lobe has density inf and evaluates to nothing; `widening(wi)` says by what factor it widens a solid angle from wo to wi.
Colours multiply outside, except where a model needs them.
"""
