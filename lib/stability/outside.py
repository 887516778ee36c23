# SPDX-License-Identifier: GPL-3.0-or-later
"""What the integrator runs and the atlas does not measure, and why.

The atlas holds closed forms and inversions. Everything else of microfacets, bsdfs, lights and sampling is one of these: a quadrature or
a table, which a test compares with an integral; integer arithmetic, which is exact; a search in a table; a chi-square test's matter,
since it only puts together factors that the atlas holds. `OUTSIDE` has all of them by name, and a test demands that every public
function and class of these rooms is either here or called by a row of the atlas.
"""

from __future__ import annotations

_QUADRATURE = (
    "a quadrature, or a table made by one: tests/lib/microfacets and bsdfs compare it with an integral or random walks"
)
_TABLE_OF_CYCLES = "a table of Cycles' own, read for a departure: tests/lib/departures compare it with Cycles"
_INTEGERS = "integer arithmetic, exact: tests/lib/sampling/test_sobol.py"
_SEARCH = "a search in a table of sums: tests/lib/sampling/test_tables.py compares frequencies"
_FACTORS = "puts together factors that the atlas holds: chi-square and white furnace in tests/lib/bsdfs"
_LIGHT = "puts together densities and directions that the atlas holds: chi-square and irradiance in tests/lib/lights"
_SPECTRUM = "a fit or a table of the spectrum: tests/lib/microfacets and tests/lib/sampling compare it with lines and quadrature"
_ADJOINT = "what tracing light asks of a light or a lobe: tests/lib/light_tracing compare its images with closed forms and with path tracing"
_SLOPES = "a special function, or a table of one: test_student_t.py and test_scale_mixture.py compare with quadrature"
_NOTHING = "no equation: it chooses, copies or describes"

OUTSIDE: dict[str, str] = {
    "microfacets.visible_slope.step_by_definition": "the definition of a step that the atlas measures as it runs, in place: "
    "tests/lib/microfacets/test_definitions.py binds the two",
    **dict.fromkeys(
        (
            "microfacets.albedo.directional_albedo",
            "microfacets.albedo.average_albedo",
            "microfacets.albedo.integrate_albedo",
            "microfacets.layers.layer_albedo",
            "microfacets.layers.average_reflectance",
            "microfacets.layers.glass_albedo",
            "microfacets.layers.average_glass_albedo",
            "microfacets.layers.integrate_glass",
            "bsdfs.layered.layer_reflectance",
            "bsdfs.layered.beneath_layer",
            "bsdfs.fresnels.Conductor",
            "bsdfs.layered.film_layer_reflectance",
            "bsdfs.films.Film",
            "bsdfs.films.FilmConductor",
            "bsdfs.films.FilmDielectric",
            "bsdfs.films.FilmF82",
            "bsdfs.films.Tabulated",
            "bsdfs.films.make_film",
            "bsdfs.films.under_film",
            "microfacets.layers.read_albedo",
            "microfacets.layers.tabulate_albedo",
            "microfacets.thin_film.Sensitivity",
            "microfacets.thin_film.amplitudes",
            "microfacets.thin_film.cosine_in_film",
            "microfacets.thin_film.exact_sensitivity",
            "microfacets.thin_film.film_color",
            "microfacets.thin_film.film_index",
            "bsdfs.sheen.sheen_coefficients",
            "bsdfs.sheen.beneath_sheen",
        ),
        _QUADRATURE,
    ),
    **dict.fromkeys(
        (
            "microfacets.albedo.directional_albedo_cycles",
            "microfacets.albedo.average_albedo_cycles",
            "microfacets.thin_film.cycles_sensitivity",
            "microfacets.cycles_tables.Tables",
            "microfacets.cycles_tables.cycles_tables",
            "microfacets.cycles_tables.tables_with",
            "bsdfs.compensated.albedos_of",
            "microfacets.cycles_tables.layer_share_cycles",
            "microfacets.cycles_tables.glass_albedo_cycles",
            "microfacets.cycles_tables.average_glass_albedo_cycles",
            "bsdfs.layered.layer_reflectance_cycles",
        ),
        _TABLE_OF_CYCLES,
    ),
    **dict.fromkeys(
        (
            "microfacets.inverse_tables.MaskingTable",
            "microfacets.inverse_tables.Spline",
            "microfacets.scale_mixture.Components",
            "microfacets.scale_mixture.ScaleMixture.sample_d_cos",
            "microfacets.scale_mixture.ScaleMixture.sample_visible",
            "microfacets.scale_mixture.ScaleMixture.smith_lambda",
            "microfacets.student_slopes.SlopeTables",
            "microfacets.student_slopes.lambda_by_beta",
            "microfacets.student_slopes.slope_tables",
            "microfacets.student_slopes.tail_by_beta",
            "microfacets.student_t.StudentT.sample_visible",
            "microfacets.student_t.StudentT.smith_lambda",
            "microfacets.student_t.StudentT.smith_lambda_by_beta",
        ),
        _SLOPES,
    ),
    **dict.fromkeys(
        (
            "microfacets.dispersion.cauchy_index",
            "sampling.wavelengths.sample_wavelength",
            "sampling.wavelengths.color_weight",
        ),
        _SPECTRUM,
    ),
    **dict.fromkeys(
        (
            "sampling.sobol.hash64",
            "sampling.sobol.stream_key",
            "sampling.sobol.sobol_pairs",
            "sampling.sobol.owen_scramble",
            "sampling.sobol.SobolSampler",
            "sampling.sobol.SobolTile",
            "sampling.sobol.RandomSampler",
            "sampling.sobol.RandomTile",
            "sampling.streams.Stream",
            "sampling.streams.step_dimension",
            "sampling.cycles_pattern.branches",
            "sampling.cycles_pattern.cycles_pairs",
            "sampling.cycles_pattern.dimension_at",
            "sampling.cycles_pattern.reverse_bits",
            "sampling.streams.occlusion_dimension",
            "sampling.streams.bevel_dimension",
            "sampling.streams.volume_step_dimension",
        ),
        _INTEGERS,
    ),
    **dict.fromkeys(
        (
            "sampling.tables.Distribution2D",
            "lights.selection.LightSelection",
            "lights.by_place.LightGrid",
            "lights.by_place.PartChances",
            "lights.cells.Cells",
            "lights.cells.Places",
            "lights.face_groups.Strips",
            "lights.face_groups.cut_faces",
            "lights.face_groups.group_pieces",
            "lights.face_groups.make_pieces",
            "lights.by_place.shares_of",
            "lights.by_place.chances_by_power",
            "lights.by_place.chances_by_place",
            "lights.environment.EnvironmentSampler",
        ),
        _SEARCH,
    ),
    **dict.fromkeys(
        (
            "bsdfs.compensated.Compensated",
            "bsdfs.dielectric.Interface",
            "bsdfs.dielectric.RoughDielectric",
            "bsdfs.dielectric.SmoothInterface",
            "bsdfs.fresnels.CookTorrance",
            "bsdfs.fresnels.Schlick",
            "bsdfs.fresnels.tinted_dielectric",
            "bsdfs.fresnels.reflectance_at_normal",
            "bsdfs.lambert.LambertTransmission",
            "bsdfs.mixture.Mixture",
            "bsdfs.rotated.Rotated",
            "bsdfs.sheen.Sheen",
            "bsdfs.specular.Mirror",
            "bsdfs.specular.SmoothDielectric",
            "bsdfs.tilted.Tilted",
            "bsdfs.toon.Toon",
            "bsdfs.toon.cone_half_angle",
            "bsdfs.velvet.Velvet",
            "sampling.warps.concentric_disk",
            "sampling.warps.regular_polygon",
        ),
        _FACTORS,
    ),
    **dict.fromkeys(
        (
            "lights.beam.BeamSampler",
            "lights.falling_off.FallingOff",
            "lights.falloff.brightness_at",
            "lights.ellipse.EllipseSampler",
            "lights.rectangle.ParallelogramSampler",
            "lights.rectangle.RectangleSampler",
            "lights.sky.SunnySampler",
            "lights.sphere.Spheres",
            "lights.spot.SphereSpotSampler",
            "lights.spot.SpotSampler",
            "lights.spot.spot_sampler",
            "lights.light.aimed_at_ball",
        ),
        _LIGHT,
    ),
    **dict.fromkeys(
        ("lights.units.LightUnits", "lights.units.light_units"),
        "products of an area or a solid angle and a radiance, for a reader: tests/lib/lights/test_units.py",
    ),
    **dict.fromkeys(("bsdfs.specular.refracted_widening", "lights.light.emit_distant"), _ADJOINT),
    **dict.fromkeys(
        (
            "bsdfs.classed.ClassedMixture",
            "bsdfs.fresnels.AveragedFresnel",
            "bsdfs.fresnels.CyclesFresnel",
            "bsdfs.fresnels.Fresnel",
            "bsdfs.fresnels.part_of",
            "bsdfs.mixture.take_color",
            "bsdfs.split.Split",
            "bsdfs.split.part_light",
            "bsdfs.lobe.DeltaLobe",
            "bsdfs.lobe.Lobe",
            "microfacets.distribution.BoundedDistribution",
            "microfacets.distribution.Distribution",
            "microfacets.distributions.distribution_by_name",
            "microfacets.scale_mixture.ScaleMixture.components",
            "microfacets.scale_mixture.ScaleMixture.slopes",
            "lights.build.area_sampler",
            "lights.build.light_sampler",
            "lights.light.LightSample",
            "lights.light.Emitter",
            "lights.light.LightSampler",
            "lights.light.Meetable",
            "lights.light.Divided",
            "lights.cells.Parts",
            "lights.face_groups.DividedFaces",
            "lights.face_groups.FaceGroups",
            "lights.face_groups.Pieces",
            "lights.face_groups.divide_faces",
            "lights.light.Aimable",
            "lights.light.Ball",
            "lights.light.Emitted",
            "lights.light.bounding_ball",
            "sampling.streams.light_step_dimension",
            "sampling.streams.walk_dimension",
            "lights.sky.suns_of",
            "lights.triangles.TriangleSample",
        ),
        _NOTHING,
    ),
}
"""Public names of lib/microfacets, lib/bsdfs, lib/lights and lib/sampling, and why they have no row."""
