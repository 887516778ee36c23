# SPDX-License-Identifier: GPL-3.0-or-later
"""Bilinear functions on the unit square, and the map that makes their density uniform.

The functions depend on further parameters.
"""

from __future__ import annotations

import itertools

import numpy as np


class SquareTable:
    """Samples on a regular grid of the square, (*parameters, height, width).

    They are bilinear on the square, and linear between parameters.

    `knots` are the increasing values of each parameter; beyond the ends the end counts. The last axis runs with x.
    """

    def __init__(self, values: np.ndarray, knots: tuple[np.ndarray, ...] = ()) -> None:
        self._shape = values.shape[-2:]
        self._values = np.asarray(values, float).reshape(-1, *self._shape)
        self._knots = knots
        self._strides = [int(np.prod([len(k) for k in knots[i + 1 :]])) for i in range(len(knots))]

    def slices(self, parameters: tuple[np.ndarray, ...]) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the slices between which parameters (n,) lie.

        They are pairs of indices and weights, (n,), which sum to 1.
        """
        ends = []
        for knots, stride, value in zip(self._knots, self._strides, parameters, strict=True):
            if len(knots) == 1:
                ends.append([(np.zeros(value.shape, int), np.ones(value.shape))])
                continue
            low = np.clip(np.searchsorted(knots, value, side="right") - 1, 0, len(knots) - 2)
            share = np.clip((value - knots[low]) / (knots[low + 1] - knots[low]), 0.0, 1.0)
            ends.append([(low * stride, 1.0 - share), ((low + 1) * stride, share)])
        return [
            (
                np.asarray(sum((i for i, _ in corner), start=np.int64(0))),
                np.asarray(np.prod([w for _, w in corner], axis=0)),
            )
            for corner in itertools.product(*ends)
        ]

    def cells(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the column and row of the cell that holds points of the square.

        The places of the points in the cell follow, in [0, 1], each (n,).
        """
        height, width = self._shape
        s, t = np.clip(x, 0.0, 1.0) * (width - 1), np.clip(y, 0.0, 1.0) * (height - 1)
        column, row = np.minimum(s.astype(int), width - 2), np.minimum(t.astype(int), height - 2)
        return column, row, s - column, t - row

    def evaluate(self, x: np.ndarray, y: np.ndarray, parameters: tuple[np.ndarray, ...] = ()) -> np.ndarray:
        """The interpolated value at points of the square, (n,)."""
        column, row, s, t = self.cells(x, y)
        total = np.zeros(x.shape)
        for index, weight in self.slices(parameters):
            v = self._values
            lower = (1.0 - s) * v[index, row, column] + s * v[index, row, column + 1]
            upper = (1.0 - s) * v[index, row + 1, column] + s * v[index, row + 1, column + 1]
            total += weight * ((1.0 - t) * lower + t * upper)
        return total


class SquareWarp(SquareTable):
    """Densities on the square, each slice scaled to the integral 1.

    `to_uniform` maps their samples to uniforms.

    y follows the marginal density, x the density given y (Dupuy and Jakob 2018, section 4.2).
    """

    def __init__(self, values: np.ndarray, knots: tuple[np.ndarray, ...] = ()) -> None:
        super().__init__(values, knots)
        height, width = self._shape
        rows = np.zeros_like(self._values)
        rows[..., 1:] = np.cumsum(0.5 * (self._values[..., 1:] + self._values[..., :-1]), axis=-1) / (width - 1)
        totals = rows[..., -1]
        below = np.zeros_like(totals)
        below[:, 1:] = np.cumsum(0.5 * (totals[:, 1:] + totals[:, :-1]), axis=-1) / (height - 1)
        scale = 1.0 / below[:, -1]
        self._values = self._values * scale[:, None, None]
        self._rows, self._below = rows * scale[:, None, None], below * scale[:, None]

    def to_uniform(
        self, x: np.ndarray, y: np.ndarray, parameters: tuple[np.ndarray, ...]
    ) -> tuple[np.ndarray, np.ndarray]:
        """The uniforms (x', y') in [0, 1] of points of the square, each (n,)."""
        column, row, s, t = self.cells(x, y)
        height, width = self._shape
        below = np.zeros(x.shape)
        inner, outer = np.zeros(x.shape), np.zeros(x.shape)
        for index, weight in self.slices(parameters):
            first, second = self._rows[index, row, -1], self._rows[index, row + 1, -1]
            part = (first * t + 0.5 * (second - first) * t * t) / (height - 1)
            below += weight * (self._below[index, row] + part)
            for at, share in ((row, 1.0 - t), (row + 1, t)):
                left, right = self._values[index, at, column], self._values[index, at, column + 1]
                part = (left * s + 0.5 * (right - left) * s * s) / (width - 1)
                inner += weight * share * (self._rows[index, at, column] + part)
                outer += weight * share * self._rows[index, at, -1]
        return np.clip(inner / np.maximum(outer, 1e-300), 0.0, 1.0), np.clip(below, 0.0, 1.0)
