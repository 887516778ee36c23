# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of an image as weights per pixel, and the moments of their weighted means.

A region's mean with fixed weights is a linear functional of the image, the same on both sides, so what is
claimed of it needs no assumption about how pixels depend on one another inside a replicate.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from ..errors import EtalonError
from .moments import Moments

BLOCK = 16

Coverage = Mapping[str, Iterable[tuple[str, np.ndarray | sparse.sparray]]]


@dataclass(frozen=True)
class Regions:
    """K regions of an image of `shape` (height, width).

    `kinds` and `names` (K each) say what a region is ('image', 'material', 'object', 'cell', 'block', ...) and how the user called it;
    `families` (K,) numbers the levels from coarse to fine: 0 the image, 1 what the user named, then one grid after the other. `boxes`
    (K, 4) are bounding boxes in pixels as first column, first row, last column, last row; `weights` (K, height * width) are sparse,
    non-negative, row-major over pixels.
    """

    shape: tuple[int, int]
    kinds: tuple[str, ...]
    names: tuple[str, ...]
    families: np.ndarray
    boxes: np.ndarray
    weights: sparse.csr_array

    def __len__(self) -> int:
        return len(self.names)

    @cached_property
    def sizes(self) -> np.ndarray:
        """Total weight (K,) of each region, in pixels."""
        return np.asarray(self.weights.sum(axis=1)).ravel()

    @cached_property
    def inside(self) -> sparse.csr_array:
        """Which regions (columns) lie in each region (rows), (K, K) of 0 and 1.

        A region lies in another if all of its weight is in pixels where the other one has weight, too.
        """
        # SciPy's types take what comparing a sparse array gives for one bool.
        shown = (self.weights > 0).astype(float)  # pyright: ignore[reportAttributeAccessIssue]
        whole = np.asarray(self.weights.sum(axis=1)).ravel()
        common = sparse.coo_array(shown @ self.weights.T)
        row, column = common.coords
        kept = common.data >= whole[column] * (1.0 - 1e-9)
        return sparse.csr_array((np.ones(kept.sum()), (row[kept], column[kept])), shape=common.shape)

    @cached_property
    def named(self) -> Regions:
        """The image and what the user named, without the grids; they stand first."""
        count = int((self.families <= 1).sum())
        return Regions(
            self.shape,
            self.kinds[:count],
            self.names[:count],
            self.families[:count],
            self.boxes[:count],
            self.weights[:count],
        )

    def indices(self, kind: str) -> np.ndarray:
        """The numbers of the regions of one kind."""
        return np.flatnonzero(np.array(self.kinds) == kind)


def image_regions(
    height: int, width: int, coverage: Coverage, blocks: Sequence[int] = (BLOCK,), left_out: np.ndarray | None = None
) -> Regions:
    """Return the regions of an image: the whole image, what `coverage` names, and blocks.

    Blocks form grids of `blocks` x `blocks` pixels. At the right and lower edge they are larger or smaller, by half a block at most.

    `coverage` maps a kind ('material', 'object') to (name, weights (height, width)) pairs, dense or sparse: the share
    of each pixel that a camera ray meets first. The grids are given from coarse to fine; regions of the last one are
    of the kind 'block', those of the others are 'cells'. Pixels that are `left_out` (height, width) belong to no
    region. What is nowhere visible makes none. Raises EtalonError for weights of another size, negative or not
    finite.
    """
    # Half of what 64 bits would take, of the largest arrays there are.
    pixels = np.arange(height * width, dtype=np.int32)
    rows = [_rows(pixels, np.ones(pixels.size), [pixels.size], pixels.size)]
    kinds, names, families, boxes = ["image"], ["whole image"], [0], [(0, 0, width - 1, height - 1)]
    for kind, entries in coverage.items():
        for name, weights in entries:
            weights = _checked(name, weights, height, width)
            if not weights.data.any():
                continue
            y, x = (place.astype(np.int32)[weights.data > 0] for place in weights.coords)
            rows.append(_rows(y * np.int32(width) + x, weights.data[weights.data > 0], [x.size], pixels.size))
            kinds.append(kind)
            names.append(name)
            families.append(1)
            boxes.append((int(x.min()), int(y.min()), int(x.max()), int(y.max())))
    for level, block in enumerate(blocks, start=2):
        weights, cells = _grid(pixels, height, width, block)
        rows.append(weights)
        kinds += ["block" if level == len(blocks) + 1 else "cell"] * len(cells)
        names += [f"x {left} to {right}, y {top} to {bottom}" for left, top, right, bottom in cells]
        families += [level] * len(cells)
        boxes += cells
    regions = Regions(
        (height, width),
        tuple(kinds),
        tuple(names),
        np.array(families),
        np.array(boxes),
        sparse.csr_array(sparse.vstack(rows)),
    )
    return regions if left_out is None else _without(regions, left_out)


def _checked(name: str, weights: np.ndarray | sparse.sparray, height: int, width: int) -> sparse.coo_array:
    """Return the coverage of what is called `name`.

    Raises EtalonError for another size, and for negative or non-finite weights.
    """
    weights = sparse.coo_array(weights, dtype=float)
    given = tuple(weights.shape or ())
    if given != (height, width):
        pixels = " x ".join(map(str, reversed(given)))
        raise EtalonError(f"{name}: its coverage is {pixels} pixels, the image {width} x {height}")
    if not np.isfinite(weights.data).all() or (weights.data < 0).any():
        raise EtalonError(f"{name}: its coverage has negative or non-finite weights")
    return weights


def _grid(
    pixels: np.ndarray, height: int, width: int, block: int
) -> tuple[sparse.csr_array, list[tuple[int, int, int, int]]]:
    """The weights and the boxes of the squares of a grid, row by row.

    What remains at an edge makes squares of its own, or belongs to those before it where it is less than half a block.
    """
    rows, columns = (max((edge + block // 2) // block, 1) for edge in (height, width))
    row, column = (
        np.minimum(k // block, n - 1) for k, n in zip(np.divmod(pixels, width), (rows, columns), strict=True)
    )
    owner = row * columns + column
    order = np.argsort(owner, kind="stable").astype(np.int32)
    weights = _rows(order, np.ones(pixels.size), np.bincount(owner).tolist(), pixels.size)
    starts = [[k * block for k in range(n)] for n in (rows, columns)]
    ends = [[*of[1:], edge] for of, edge in zip(starts, (height, width), strict=True)]
    down, across = (list(zip(*of, strict=True)) for of in zip(starts, ends, strict=True))
    return weights, [(left, top, right - 1, bottom - 1) for top, bottom in down for left, right in across]


def _without(regions: Regions, left_out: np.ndarray) -> Regions:
    """The regions without pixels (height, width); those that lose all of theirs are gone."""
    weights = sparse.csr_array(regions.weights.multiply(~left_out.ravel()))
    weights.eliminate_zeros()
    kept = np.flatnonzero(np.diff(weights.indptr))
    kinds, names = (tuple(np.array(of, object)[kept]) for of in (regions.kinds, regions.names))
    return Regions(regions.shape, kinds, names, regions.families[kept], regions.boxes[kept], weights[kept])


def _rows(pixel: np.ndarray, weight: np.ndarray, counts: Sequence[int], pixels: int) -> sparse.csr_array:
    """Rows of `counts` weights each, one after the other, over so many `pixels`."""
    ends = np.concatenate([[0], np.cumsum(counts)]).astype(np.int32)
    return sparse.csr_array((weight, pixel, ends), shape=(len(counts), pixels))


class RegionMoments:
    """The moments of the means of `regions` over replicates.

    `moments` (K, 3); pixels that are `excluded` (height, width) count for nothing.

    `sizes` (K,) is the weight that is left in each region, in pixels; `series` (R, K) the mean over channels in each
    replicate, NaN where a region was not sampled or has lost pixels since; `weights` (R,) how many times the usual
    samples each replicate has.
    """

    def __init__(self, regions: Regions, excluded: np.ndarray | None = None) -> None:
        self.regions = regions
        self.moments = Moments.empty((len(regions), 3))
        self.excluded = np.zeros(regions.shape, bool) if excluded is None else excluded
        self.sizes = regions.weights @ (~self.excluded.ravel()).astype(float)
        self.most_drawn = np.inf
        self._series: list[np.ndarray] = []
        self._weights: list[int] = []

    def drawn(self, samples: int) -> np.ndarray:
        """Return the number of independent samples (K,) of each region in a replicate.

        The replicate has weight 1 and `samples` per pixel.

        They are `most_drawn` at most, which is set where all pixels share a few moments of the shutter.
        """
        return np.minimum(self.sizes * samples, self.most_drawn)

    @property
    def series(self) -> np.ndarray:
        """The mean over channels of each region in each replicate."""
        return np.array(self._series).reshape(len(self._series), len(self.regions))

    @property
    def weights(self) -> np.ndarray:
        """The samples of each replicate, in units of the usual number."""
        return np.array(self._weights, float)

    def means(self, radiance: np.ndarray, of: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Return the means (K, 3) of an image (height, width, 3) over the regions `of`.

        NaN where no pixel is left.
        """
        kept = radiance.reshape(-1, 3)
        if self.excluded.any():
            kept = np.where(self.excluded.reshape(-1, 1), 0.0, kept)
        weights = self.regions.weights if isinstance(of, slice) else self.regions.weights[of]
        sizes = self.sizes[of]
        return (weights @ kept) / np.where(sizes > 0, sizes, np.nan)[:, None]

    def add(self, radiance: np.ndarray, of: np.ndarray | None = None, weight: int = 1) -> None:
        """Add one replicate (height, width, 3), of `weight`.

        It counts for all regions, or only for the regions `of` (K,) bool if they are given.
        """
        self._weights.append(weight)
        if of is None:
            values = self.means(radiance)
            self.moments.add(values, weight=weight)
            self._series.append(values.mean(axis=1, dtype=np.float32))
            return
        values = np.zeros_like(self.moments.mean)
        values[of] = self.means(radiance, np.flatnonzero(of))
        self.moments.add(values, of, weight)
        self._series.append(np.where(of, values.mean(axis=1), np.nan).astype(np.float32))

    def exclude(self, pixels: np.ndarray, film: Moments, of: np.ndarray | None = None) -> None:
        """Leave out `pixels` (height, width) bool, also in the replicates that were added before.

        They are left out of all regions, or only of the regions `of`, if these are given.

        `film` holds the pixels' own moments over those replicates. The mean without them is then known exactly; of
        its m2 the covariance is not known, so it is bounded from above: the norm of a sum is at most the sum of norms
        (Cauchy-Schwarz), hence sqrt(m2(S - sum w x)) <= sqrt(m2(S)) + sum w sqrt(m2(x)). Claims stay valid, at worst
        late.
        """
        new = pixels & ~self.excluded
        if not new.any():
            return
        self.excluded = self.excluded | new
        columns = np.flatnonzero(new)
        weights = self.regions.weights[:, columns]
        lost = np.asarray(weights.sum(axis=1)).ravel()
        touched = np.flatnonzero((lost > 0) if of is None else (lost > 0) & of)
        if touched.size == 0:
            return
        weights = weights[touched]
        before = self.sizes[touched, None]
        self.sizes[touched] = self.regions.weights[touched] @ (~self.excluded.ravel()).astype(float)
        after = self.sizes[touched, None]
        mean, spread = film.mean.reshape(-1, 3)[columns], np.sqrt(film.m2.reshape(-1, 3)[columns])
        share = np.where(after > 0, after, np.nan)
        moments = self.moments
        moments.mean[touched] = (moments.mean[touched] * before - weights @ mean) / share
        moments.m2[touched] = ((np.sqrt(moments.m2[touched]) * before + weights @ spread) / share) ** 2
        for values in self._series:
            values[touched] = np.nan
