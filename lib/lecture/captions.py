# SPDX-License-Identifier: GPL-3.0-or-later
"""What the page says around its figures, in English and French."""

from __future__ import annotations

from .figure import Caption, Words

TITLE = Words("The lecture, computed", "Le cours, calculé")
INTRODUCTION = Words(
    "What the slides of D. Meneveaux and M. Ribardière (XLIM, Poitiers) show about importance sampling, computed by the reference "
    "integrator. Every figure names its slide, the command that remakes it and the test that holds its numbers, which lie in this page "
    "as JSON.",
    "Ce que montrent les diapositives de D. Meneveaux et M. Ribardière (XLIM, Poitiers) sur l'échantillonnage d'importance, calculé par "
    "l'intégrateur de référence. Chaque figure nomme sa diapositive, la commande qui la refait et le test qui garantit ses nombres, "
    "inclus dans cette page en JSON.",
)
REMADE = Words("Remake", "Refaire")
HELD = Words("Test", "Test")
DRAG = Words(
    "Drag the point in any of the three pictures, or move it with the sliders (arrow keys).",
    "Déplacez le point dans l'une des trois images, ou par les curseurs (touches fléchées).",
)
OBSERVER = Words("observer", "observateur")
CELL = Words("The coloured cell widens by", "La cellule colorée s'élargit")
BELOW = Words("below the surface: no light", "sous la surface : aucune lumière")
BY_REFERENCE = Words("Reference", "Référence")
DIFFERENCE = Words("Relative difference, colour up to ± 20 %", "Différence relative, couleur jusqu'à ± 20 %")
BY_FLIP = Words("FLIP: white is 1", "FLIP : le blanc vaut 1")
BOTH_MODELS = Words("reference alone", "référence seule")
MISSING = Words("Not rendered.", "Pas de rendu.")
TRACED = Words("Path tracing", "Tracé de chemins")
GATHERED = Words("Gathering at each point", "Rassemblement en chaque point")
CACHE_HEADS = (
    Words("method", "méthode"),
    Words("time", "temps"),
    Words("mean against path tracing", "moyenne contre tracé de chemins"),
    Words("a pixel (RMS)", "un pixel (RMS)"),
    Words("records", "points"),
    Words("bias of caching: mean, pixel", "biais du cache : moyenne, pixel"),
)
ROW_HEADS = (
    Words("sphere", "sphère"),
    Words("verdict", "verdict"),
    Words("difference", "différence"),
    Words("at most", "au plus"),
    Words("FLIP", "FLIP"),
    Words("FLIP of noise alone", "FLIP du bruit seul"),
)

CAPTIONS = {
    "densities": Caption(
        "Distributions (D) utilisées habituellement",
        Words("D for the four sigmas", "D pour les quatre sigmas"),
        Words(
            "D of Beckmann (full lines) and GGX (dashed) for sigma = 0.01, 0.1, 0.3 and 0.5, against the angle of the facet. Beside each "
            "name stands the integral of D cos over the hemisphere, which must be 1. GGX has more facets far from the normal.",
            "D de Beckmann (traits pleins) et de GGX (tirets) pour sigma = 0,01, 0,1, 0,3 et 0,5, selon l'angle de la facette. À côté de "
            "chaque nom, l'intégrale de D cos sur l'hémisphère, qui doit valoir 1. GGX a davantage de facettes loin de la normale.",
        ),
        "tests/lib/lecture/test_numbers.py::test_each_density_integrates_to_one",
    ),
    "facets": Caption(
        "Echantillonnage d'importance",
        Words("Facets drawn by D cos, and those that are seen", "Facettes tirées selon D cos, et celles que l'on voit"),
        Words(
            "Facets of Beckmann's distribution, sigma = 0.5, seen from above; the observer is at 75 degrees on the right. Red facets are "
            "wasted: they face away from the observer, or reflect below the surface. First disc: drawn by D cos. Second: drawn among "
            "the facets that the observer sees. The share of useful facets stands below each disc.",
            "Facettes de la distribution de Beckmann, sigma = 0,5, vues de dessus ; l'observateur est à 75 degrés, à droite. Les facettes "
            "rouges sont perdues : elles tournent le dos à l'observateur, ou réfléchissent sous la surface. Premier : tirées selon D cos. "
            "Second : tirées parmi les facettes que voit l'observateur. La part des facettes utiles est sous chaque disque.",
        ),
        "tests/lib/lecture/test_numbers.py::test_visible_normals_all_face_the_observer",
    ),
    "uniform": Caption(
        "Uniforme ?",
        Words("Uniform? One point by four strategies", "Uniforme ? Un point par quatre stratégies"),
        Words(
            "The light that one point of a GGX surface (sigma = 0.1) reflects to an observer at 45 degrees, under a sky with a broad light. "
            "Relative error (root mean square over 64 replicates) against the number of samples; the slope stands beside each name. "
            "Independent samples (full lines) fall with slope -1/2. Owen-scrambled Sobol' points (dashed) fall faster where the integrand is "
            "smooth in them. The table has the time of a sample on this machine, and the error after the same millisecond.",
            "La lumière qu'un point d'une surface GGX (sigma = 0,1) réfléchit vers un observateur à 45 degrés, sous un ciel avec une large "
            "source. Erreur relative (moyenne quadratique sur 64 répétitions) selon le nombre de tirages ; la pente est à côté de chaque "
            "nom. Les tirages indépendants (traits pleins) suivent la pente -1/2. Les points de Sobol' brouillés selon Owen (tirets) "
            "convergent plus vite là où l'intégrande en dépend de façon lisse. Le tableau donne le temps d'un tirage sur cette machine, et "
            "l'erreur après la même milliseconde.",
        ),
        "tests/lib/lecture/test_numbers.py::test_every_strategy_estimates_the_integral_with_slope_one_half",
    ),
    "inversions": Caption(
        "Exemple 2 – distribution de Beckmann",
        Words("From (xi1, xi2) to m to i", "De (xi1, xi2) à m, puis à i"),
        Words(
            "The unit square in 144 cells, the same cells as normals m by theta = atan(sqrt(-sigma² log(1 - xi2))), and as directions i by "
            "reflection of an observer at 30 degrees; cells that reach below the surface are not drawn. All cells of the square are "
            "equally likely. The last step widens the coloured cell by the factor 4 |o.m|, which the slides leave out of the density.",
            "Le carré unité en 144 cellules, les mêmes cellules comme normales m par theta = atan(sqrt(-sigma² log(1 - xi2))), et comme "
            "directions i par réflexion d'un observateur à 30 degrés ; les cellules qui passent sous la surface ne sont pas tracées. Toutes "
            "les cellules du carré sont équiprobables. La dernière étape élargit la cellule colorée du facteur 4 |o.m|, que les "
            "diapositives omettent dans la densité.",
        ),
        "tests/lib/lecture/test_numbers.py::test_reflection_widens_a_cell_by_four_cosines",
    ),
    "slips": Caption(
        "Distributions, Echantillonnage d'importance, Exemple 1, Ombrage et Masquage",
        Words("Five slips, and the number that decides each", "Cinq lapsus, et le nombre qui tranche"),
        Words(
            "Where the slides contradict themselves. The integrals must be 1. In the fifth row it is the number of places, of four, where "
            "the formula is 0/0 in floating point.",
            "Là où les diapositives se contredisent. Les intégrales doivent valoir 1. À la cinquième ligne : le nombre d'endroits, sur "
            "quatre, où la formule donne 0/0 en virgule flottante.",
        ),
        "tests/lib/microfacets/test_slips.py, tests/lib/lecture/test_numbers.py::test_each_slip_is_decided_by_its_number",
    ),
    "illustrations": Caption(
        "Quelques illustrations",
        Words(
            "Both rows by both renderers: does the eye see it?",
            "Les deux rangées par les deux moteurs : l'œil le voit-il ?",
        ),
        Words(
            "Spheres of Beckmann (above) and GGX (below) for sigma = 0.01, 0.1, 0.3 and 0.5, left to right, by the reference and by "
            "Cycles. For each sphere: whether Cycles agrees to within 3 %, by how much its light differs, the largest difference that the "
            "data have not ruled out, and the mean of FLIP over the sphere, which estimates what an eye notices (0 nothing, 1 everything). "
            "FLIP of noise alone is what the noise of both pictures gives by itself. The last rows put GGX in place of Beckmann's "
            "distribution in the upper row, by the reference: that is what the choice of D does to the light and to the eye.",
            "Sphères de Beckmann (en haut) et de GGX (en bas) pour sigma = 0,01, 0,1, 0,3 et 0,5, de gauche à droite, par la référence et "
            "par Cycles. Pour chaque sphère : si Cycles concorde à 3 % près, de combien sa lumière diffère, la plus grande différence que "
            "les données n'excluent pas, et la moyenne de FLIP sur la sphère, qui estime ce que l'œil remarque (0 rien, 1 tout). Le FLIP "
            "du bruit seul est ce que donne le bruit des deux images. Les dernières lignes mettent GGX à la place de Beckmann dans la "
            "rangée du haut, par la référence : ce que le choix de D change pour la lumière et pour l'œil.",
        ),
        "tests/lib/lecture/test_illustrations.py",
    ),
    "caches": Caption(
        "Conclusion: Et autres familles de méthodes (tracé de photons, caches, radiativité, etc.)",
        Words(
            "Radiosity and irradiance caching in a diffuse box",
            "Radiosité et cache d'éclairement dans une boîte diffuse",
        ),
        Words(
            "A closed box of diffuse walls with a lamp in the ceiling. Path tracing has noise and no bias. Radiosity solves for the light of "
            "each patch at once: no noise, but each patch has one colour, and the error falls with their size. A last gathering at each "
            "point, of the light of 384 patches, mends most of it. Irradiance caching gathers at a few records and interpolates indirect "
            "light between them; the last column states its bias, against gathering at each point. Pixels on edges and on the lamp do not "
            "count.",
            "Une boîte fermée aux parois diffuses, avec une lampe au plafond. Le tracé de chemins a du bruit et aucun biais. La radiosité "
            "résout d'un coup la lumière de chaque facette : aucun bruit, mais une seule couleur par facette, et l'erreur diminue avec leur "
            "taille. Un dernier rassemblement en chaque point, de la lumière de 384 facettes, en corrige l'essentiel. Le cache d'éclairement "
            "rassemble en quelques points et interpole entre eux la lumière indirecte ; la dernière colonne donne son biais, par rapport au "
            "rassemblement en chaque point. Les pixels des arêtes et de la lampe ne comptent pas.",
        ),
        "tests/lib/lecture/test_caches.py",
    ),
    "masking": Caption(
        "Choix de F, D et G",
        Words("Which geometry underlies G?", "Quelle géométrie sous-jacente à G ?"),
        Words(
            "Height fields with Beckmann's slopes (sigma = 0.6), traced: the share of level facets that see both a direction and its mirror "
            "image, with the standard error over four independent fields, beside three formulas. V-cavities are another surface.",
            "Champs de hauteurs aux pentes de Beckmann (sigma = 0,6), tracés : la part des facettes horizontales qui voient à la fois une "
            "direction et son image miroir, avec l'erreur type sur quatre champs indépendants, à côté de trois formules. Les cavités en V "
            "sont une autre surface.",
        ),
        "tests/lib/microsurface/test_height_field.py",
    ),
}
"""One row for each figure, by the name that `--only` takes, in the order of the page."""
