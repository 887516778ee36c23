# SPDX-License-Identifier: GPL-3.0-or-later
"""Every sampler against its density, over a grid of cases.

The grid has distributions, roughness, anisotropy, angles, strategies and lights. One level for all of it: a right
sampler fails the whole grid once in a thousand runs of new seeds. The default run takes a fixed twentieth, chosen by name;
the rest is marked slow. Expected counts come from quadrature in the sampler's own warped domain.
"""

import zlib
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from etalon.lib.bsdfs.dielectric import Interface, RoughDielectric
from etalon.lib.bsdfs.fresnels import Dielectric
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.bsdfs.sheen import Sheen
from etalon.lib.bsdfs.toon import Toon, cone_half_angle
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.environment import EnvironmentSampler
from etalon.lib.microfacets import densities
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.microfacets.scale_mixture import ExponentialPower, ShiftedGamma
from etalon.lib.microfacets.student_t import StudentT
from etalon.lib.scene.lights import AreaLight, SphereLight, SpotLight, SunLight
from etalon.lib.scene.lights import Cone as SpotCone
from etalon.tests.charts import Cone, Flat, Refractions, Sky
from etalon.tests.chi2 import Reflections, Sphere, Tangents, chi_square, sidak

STUDENT = {f"student-t {g:g}": StudentT(g) for g in (1.8, 2.5, 12.0)}
MIXTURES = {"shifted gamma": ShiftedGamma(0.8, 0.01), "exponential power": ExponentialPower(0.5)}
DISTRIBUTIONS = {"ggx": GGX(), "beckmann": Beckmann(), **STUDENT, **MIXTURES}
ISOTROPIC = [(a, a) for a in (1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.3, 0.6, 1.0)]
ANISOTROPIC = [(1e-4, 1e-3), (1e-2, 1e-4), (0.01, 0.3), (0.3, 0.05), (1.0, 0.1), (0.1, 1.0), (0.5, 0.4), (1.0, 1e-3)]
ANGLES = (0.0, 20.0, 45.0, 70.0, 85.0, 89.0, 89.9)
COUNT = 20_000
COARSE = {"bins": (12, 16), "tolerance": 3e-6}


def view(degrees, count=1, phi=0.6):
    theta = np.radians(degrees)
    wo = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return np.repeat(wo[:, None], count, axis=1)


@dataclass(frozen=True)
class Normals:
    """Visible normals by themselves, over all of the normals' hemisphere."""

    distribution: str
    alpha: tuple[float, float]
    degrees: float

    def test(self, rng):
        module = DISTRIBUTIONS[self.distribution]
        m = module.sample_visible(view(self.degrees, COUNT), *self.alpha, *rng.random((2, COUNT)))
        return m, self.density, Tangents(*self.alpha), {}

    def density(self, m):
        module, wo = DISTRIBUTIONS[self.distribution], view(self.degrees, m.shape[1])
        return densities.pdf_visible(m, wo, module.density(m, *self.alpha), module.smith_lambda(wo, *self.alpha))


@dataclass(frozen=True)
class Lobe:
    """A glossy lobe as the integrator has it: reflected directions above the surface."""

    distribution: str
    strategy: str
    alpha: tuple[float, float]
    degrees: float

    def lobe(self, count):
        module = DISTRIBUTIONS[self.distribution]
        return MicrofacetReflection(view(self.degrees, count), *self.alpha, module, "correlated", self.strategy)

    def test(self, rng):
        wi, _, _ = self.lobe(COUNT).sample(*rng.random((2, COUNT)))
        wi[:, wi[2] <= 0.0] = np.nan
        if self.strategy in ("cosine", "uniform"):
            return wi, self.density, Sphere(), {}
        chart = Reflections(view(self.degrees)[:, 0], Tangents(*self.alpha))
        return wi, self.density, chart, COARSE

    def density(self, wi):
        return self.lobe(wi.shape[1]).evaluate(wi)[1]


@dataclass(frozen=True)
class Interfaces:
    """A rough interface: what it refracts."""

    distribution: str
    alpha: tuple[float, float]
    eta: float
    glass: bool
    degrees: float

    def lobe(self, count):
        module = DISTRIBUTIONS[self.distribution]
        fresnel = Dielectric(np.float64(self.eta)) if self.glass else None
        interface = Interface(fresnel, np.ones((3, 1)), np.ones((3, 1)))
        return RoughDielectric(
            view(self.degrees, count), *np.array(self.alpha), np.float64(self.eta), module, interface
        )

    def test(self, rng):
        wi, weight, _ = self.lobe(COUNT).sample(*rng.random((2, COUNT)))
        wi[:, (wi[2] >= 0.0) | ~(weight[0] > 0.0)] = np.nan
        chart = Refractions(view(self.degrees)[:, 0], self.eta, Tangents(*self.alpha))
        return wi, self.density, chart, COARSE

    def density(self, wi):
        return np.where(wi[2] < 0.0, self.lobe(wi.shape[1]).evaluate(wi)[1], 0.0)


WIDE = {"sheen": Sheen, "toon": partial(Toon, glossy=False), "glossy toon": partial(Toon, glossy=True)}


@dataclass(frozen=True)
class Cloth:
    """Sheen of a roughness, or a cone of a size and an edge."""

    name: str
    shape: tuple[float, ...]
    degrees: float

    def lobe(self, count):
        return WIDE[self.name](view(self.degrees, count), *map(np.float64, self.shape))

    def test(self, rng):
        wi, _, pdf = self.lobe(COUNT).sample(*rng.random((2, COUNT)))
        wi[:, pdf <= 0.0] = np.nan
        if self.name == "sheen":
            return wi, self.density, Sphere(), COARSE
        x, y, z = view(self.degrees)[:, 0]
        axis = np.array([-x, -y, z]) if self.name == "glossy toon" else np.array([0.0, 0.0, 1.0])
        chart = Cone(axis, 1.0 - np.cos(cone_half_angle(*self.shape)))
        return wi, self.density, chart, COARSE | {"tolerance": 3e-4}  # a horizon may cross the chart

    def density(self, wi):
        return self.lobe(wi.shape[1]).evaluate(wi)[1]


def area(shape, spread=np.pi, edge_v=(0.0, 1.0, 0.0)):
    return AreaLight(
        "area", (0.3, -0.2, 2.0), (1.5, 0.0, 0.0), edge_v, (0.0, 0.0, -1.0), shape, (1.0, 1.0, 1.0), spread
    )


CONE = SpotCone((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), np.cos(0.6), 0.4)
LIGHTS = {
    "rectangle": area("RECTANGLE"),
    "rectangle with spread": area("RECTANGLE", 3.0),
    "parallelogram": area("RECTANGLE", edge_v=(0.4, 1.0, 0.0)),
    "ellipse": area("ELLIPSE"),
    "sheared ellipse": area("ELLIPSE", edge_v=(0.4, 1.0, 0.0)),
    "strip": area("RECTANGLE", edge_v=(0.0, 0.001, 0.0)),
    "sphere": SphereLight("sphere", (0.2, 0.1, 2.0), 0.5, (1.0, 1.0, 1.0)),
    "speck": SphereLight("speck", (0.2, 0.1, 2.0), 1e-4, (1.0, 1.0, 1.0)),
    "spot": SpotLight("spot", (0.2, 0.1, 2.0), 0.5, (1.0, 1.0, 1.0), CONE),
    "sun": SunLight("sun", (0.0, 0.6, 0.8), 0.2, (1.0, 1.0, 1.0)),
    "narrow sun": SunLight("narrow sun", (0.0, 0.6, 0.8), 1e-5, (1.0, 1.0, 1.0)),
}
POINTS = {
    "under": (0.3, -0.2, 0.0),
    "aside": (-2.0, 1.0, 1.2),
    "close": (0.35, -0.25, 1.99),
    "closer": (0.4, 0.1, 1.9999),
    "edge on": (4.0, 0.3, 1.999),
    "far": (30.0, -40.0, -500.0),
    "very far": (3e4, -4e4, -5e5),
    "beside a corner": (1.05, 0.3, 1.5),
    "below": (0.2, 0.1, -3.0),
    "low": (-20.0, 0.0, 1.9),
}


@dataclass(frozen=True)
class Towards:
    """A light from a point."""

    light: str
    point: str

    @property
    def sampler(self):
        return light_sampler(LIGHTS[self.light], 10.0)

    def points(self, count):
        return np.repeat(np.array(POINTS[self.point])[:, None], count, axis=1)

    def test(self, rng):
        sample = self.sampler.sample(self.points(COUNT), *rng.random((2, COUNT)))
        return sample.wi, self.density, self.chart(), COARSE

    def density(self, wi):
        points = self.points(wi.shape[1])
        distance, _ = self.sampler.intersect(points, wi)
        return self.sampler.pdf(points, wi, np.where(np.isfinite(distance), distance, self.met(wi)))

    def met(self, wi):
        """The distance where `intersect` has none.

        The direction lies on the rim then, or the light is at infinity.
        """
        light = LIGHTS[self.light]
        if not isinstance(light, AreaLight):
            return np.full(wi.shape[1], np.inf if isinstance(light, SunLight) else 1.0)
        return (light.center[2] - POINTS[self.point][2]) / wi[2]

    def chart(self):
        light, point = LIGHTS[self.light], np.array(POINTS[self.point])
        if isinstance(light, AreaLight):
            edges = np.array(light.edge_u), np.array(light.edge_v)
            return Flat(point, np.array(light.center), *edges, light.shape == "ELLIPSE")
        if isinstance(light, SunLight):
            return Cone(np.array(light.direction), 2.0 * np.sin(0.5 * light.half_angle) ** 2)
        axis = np.array(light.position) - point
        distance = np.linalg.norm(axis)
        if distance <= light.radius:
            return Sphere()
        sine2 = (light.radius / distance) ** 2
        return Cone(axis / distance, sine2 / (1.0 + np.sqrt(1.0 - sine2)))


@dataclass(frozen=True)
class World:
    """A table of the sky."""

    kind: str
    rows: int

    def radiance(self, d):
        x, y, z = d
        value = {
            "even": np.ones_like(z),
            "dome": np.maximum(z, 0.0),
            "hot": 1.0 + 1e6 * (x * 0.6 + z * 0.8 > 0.995),
            "stripes": 1.0 + np.cos(8.0 * np.arctan2(y, x)),
            "pole": 1.0 / (1.0001 - z),
            "dark": np.zeros_like(z),
        }[self.kind]
        return np.tile(value, (3, 1))

    def test(self, rng):
        sampler = EnvironmentSampler(self.radiance, (2 * self.rows, self.rows))
        sample = sampler.sample(np.zeros((3, COUNT)), *rng.random((2, COUNT)))
        density = lambda wi: sampler.pdf(np.zeros_like(wi), wi, np.full(wi.shape[1], np.inf))  # noqa: E731
        return sample.wi, density, Sky(self.rows), {"bins": (self.rows, 2 * self.rows), "tolerance": 3e-6}


def grid():
    """Name -> configuration."""
    cases = []
    for name in (*STUDENT, *MIXTURES):
        for alpha in ((0.01, 0.01), (0.3, 0.3), (0.7, 0.7), (0.3, 0.05), (0.1, 1.0)):
            for degrees in ANGLES[::2]:
                cases.append(Normals(name, alpha, degrees))
                cases += [Lobe(name, strategy, alpha, degrees) for strategy in ("visible", "d_cos")]
    for name in ("ggx", "beckmann"):
        strategies = ("visible", "bounded", "d_cos") if name == "ggx" else ("visible", "d_cos")
        for alpha in (*ISOTROPIC, *ANISOTROPIC):
            for degrees in ANGLES:
                cases.append(Normals(name, alpha, degrees))
                cases += [Lobe(name, strategy, alpha, degrees) for strategy in strategies]
        cases += [Lobe(name, strategy, (0.3, 0.3), degrees) for strategy in ("cosine", "uniform") for degrees in ANGLES]
        cases += [
            Interfaces(name, alpha, eta, glass, degrees)
            for alpha in (*((a, a) for a in (1e-3, 0.05, 0.3, 1.0)), (0.3, 0.05), (0.1, 1.0), (1.0, 1e-3))
            for eta in (1.5, 1.0 / 1.5)
            for glass in (True, False)
            for degrees in (0.0, 45.0, 80.0, 89.9)
            if glass or eta > 1.0  # without Fresnel the density ends in a step where total reflection begins
        ]
    cases += [Cloth("sheen", (r,), degrees) for r in (0.1, 0.3, 0.6, 1.0) for degrees in ANGLES]
    cones = ((0.2, 0.0), (0.5, 0.2), (0.9, 0.3))
    cases += [Cloth(name, shape, 60.0) for name in ("toon", "glossy toon") for shape in cones]
    cases += [Towards(light, point) for light in LIGHTS for point in POINTS]
    cases += [World(kind, rows) for kind in ("even", "dome", "hot", "stripes", "pole", "dark") for rows in (4, 8, 16)]
    return {" ".join(map(str, (type(case).__name__, *vars(case).values()))): case for case in cases}


GRID = grid()
LEVEL = sidak(1e-3, len(GRID))


def p_value(case, rng, distort=lambda value: value):
    samples, density, chart, how = case.test(rng)
    return chi_square(samples, lambda d: distort(density(d)), chart, **how).p_value


def of_the_default_run(name):
    return zlib.crc32(name.encode()) % 20 == 0


def test_the_grid_is_large_and_a_twentieth_of_it_runs():
    assert len(GRID) >= 1000
    share = sum(map(of_the_default_run, GRID)) / len(GRID)
    assert 0.035 < share < 0.065
    for kind in (Normals, Lobe, Interfaces, Cloth, Towards, World):
        assert any(of_the_default_run(name) and isinstance(case, kind) for name, case in GRID.items())


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if of_the_default_run(name) else pytest.mark.slow) for name in GRID]
)
def test_sampler_follows_its_density(name, rng):
    assert p_value(GRID[name], rng) > LEVEL


PLANTED = [
    Normals("ggx", (0.3, 0.05), 70.0),
    Lobe("ggx", "visible", (1e-4, 1e-4), 45.0),
    Lobe("ggx", "bounded", (0.3, 0.3), 20.0),
    Lobe("beckmann", "d_cos", (0.1, 0.1), 45.0),
    Normals("student-t 2.5", (0.3, 0.05), 70.0),
    Interfaces("beckmann", (0.3, 0.3), 1.5, True, 45.0),
    Cloth("sheen", (0.3,), 70.0),
    Towards("rectangle", "aside"),
    Towards("sphere", "very far"),
    World("hot", 8),
]


@pytest.mark.parametrize("case", PLANTED, ids=str)
@pytest.mark.parametrize("factor", [1.03, 0.97, 4.0, 0.25])
def test_a_planted_factor_fails(case, factor, rng):
    assert p_value(case, rng, partial(np.multiply, factor)) < LEVEL


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        (Lobe("ggx", "visible", (0.3, 0.3), 70.0), Lobe("ggx", "d_cos", (0.3, 0.3), 70.0)),
        (Lobe("ggx", "bounded", (0.6, 0.6), 45.0), Lobe("ggx", "visible", (0.6, 0.6), 45.0)),
        (Normals("ggx", (0.3, 0.3), 45.0), Normals("beckmann", (0.3, 0.3), 45.0)),
        (Normals("student-t 2.5", (0.3, 0.3), 45.0), Normals("ggx", (0.3, 0.3), 45.0)),
        (Lobe("beckmann", "visible", (0.3, 0.05), 45.0), Lobe("beckmann", "visible", (0.05, 0.3), 45.0)),
        (Interfaces("ggx", (0.3, 0.3), 1.5, True, 45.0), Interfaces("ggx", (0.3, 0.3), 1.5, False, 45.0)),
        (Interfaces("ggx", (0.3, 0.1), 1.5, True, 45.0), Interfaces("ggx", (0.1, 0.3), 1.5, True, 45.0)),
    ],
    ids=str,
)
def test_another_lobes_density_fails(right, wrong, rng):
    samples, _, chart, how = right.test(rng)
    assert chi_square(samples, wrong.density, chart, **how).p_value < LEVEL
