# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance of Cycles' image of a sphere from the model, beyond its stated variance.

It also prints what a fit then sees.

    python tests/benchmarks/fit_noise.py [--samples 1024]

For GGX spheres of known alpha: the root mean square of relative residuals beside the standard error of the
replicates, in the half of the pixels with the least noise. RENDER_NOISE of lib/fit/sphere.py follows from it. Then p
of the best candidate for a sphere of two lobes that is no candidate, with that noise and with five times as much.
"""

from __future__ import annotations

import argparse

import bpy
import numpy as np
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.addon.job import export
from etalon.addon.sphere import observe_sphere
from etalon.lib.film.moments import Moments
from etalon.lib.fit.candidates import Candidate
from etalon.lib.fit.identify import identify
from etalon.lib.fit.solve import solve_linear
from etalon.lib.fit.sphere import RENDER_NOISE, observe_image, require_sphere
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.settings.fit import FitSettings
from etalon.lib.textures.fold import fold_scene
from etalon.tests.addon.test_fit import sphere

GGX = Candidate("ggx", "correlated", "none", False)
ROUGHNESS, SIZE, REPLICATES = (0.8, 0.7, 0.6), 32, 16
SHARES = (1e-4, 3e-4)


def residuals(roughness: float, samples: int) -> tuple[float, float]:
    """Return the root mean squares of the relative residuals and of the standard errors.

    They are those of the quieter half of the pixels.
    """
    scene = sphere(roughness, size=SIZE)
    with quiet():
        exported = fold_scene(export(scene))
        sun, _ = require_sphere(exported, None)
        moments = Moments.empty((SIZE, SIZE))
        with neutral(scene, threads=2):
            cycles = CyclesRenderer(scene, seed=1, threads=2)
            for number in range(REPLICATES):
                moments.add(cycles.render(number, samples).radiance.mean(axis=2))
    seen = observe_image(exported, sun, moments, RENDER_NOISE, "sphere")
    _, predicted, _ = solve_linear(GGX, seen.at_level(seen.values), np.log([roughness**2]))
    pixel = [int(np.flatnonzero(moments.mean.ravel() == value)[0]) for value in seen.values[0]]
    errors = moments.standard_error.ravel()[pixel] / predicted[0]
    quiet_half = np.argsort(errors)[: len(errors) // 2]
    relative = (seen.values / predicted - 1.0)[0, quiet_half]
    return float(np.sqrt(np.square(relative).mean())), float(np.sqrt(np.square(errors[quiet_half]).mean()))


def two_lobes(share: float) -> bpy.types.Scene:
    """A sphere of roughness 0.8, with `share` of a lobe of roughness 0.4."""
    scene = sphere(0.8, size=SIZE)
    tree = bpy.data.materials["Glossy"].node_tree
    output = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    first = output.inputs["Surface"].links[0].from_node
    second, mix = tree.nodes.new("ShaderNodeBsdfAnisotropic"), tree.nodes.new("ShaderNodeMixShader")
    second.distribution = "GGX"
    second.inputs["Roughness"].default_value = 0.4
    mix.inputs[0].default_value = share
    for source, target in ((first.outputs[0], mix.inputs[1]), (second.outputs[0], mix.inputs[2])):
        tree.links.new(source, target)
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    return scene


def main() -> None:
    """Print a line for each sphere."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=1024)
    samples = parser.parse_args().samples
    for roughness in ROUGHNESS:
        found, stated = residuals(roughness, samples)
        print(f"alpha {roughness**2:.2f}: residuals {found:.1e}, stated standard error {stated:.1e}", flush=True)
    for share in SHARES:
        for noise in (RENDER_NOISE, 5.0 * RENDER_NOISE):
            seen = observe_sphere(two_lobes(share), FitSettings(threads=2, noise=noise), NO_PROGRESS, "two lobes")
            found = identify(seen)
            print(
                f"{share:.2%} of a second lobe, noise {noise:.0e}: fits {found.fits}, p = {found.p_value:.2g}",
                flush=True,
            )


if __name__ == "__main__":
    main()
