# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole comparison in one function: two renderers, their films and the verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from ..errors import Cancelled, EtalonError
from ..film.film import nonfinite_pixels
from ..film.parts import Part
from ..film.regions import BLOCK, Coverage, image_regions
from ..light_tracing.scouting import Scouted
from ..pages.formats import format_bound, format_duration
from ..progress import NO_PROGRESS, Progress
from ..sampling.streams import COUNTED
from ..scene.scene import Scene
from ..settings.comparison import CompareOptions
from ..verdict.attribution import ATTRIBUTION_SHARE
from ..verdict.boundaries import EXPECTED_LOOKS, FIRST_LOOK, GROWTH, count_looks, next_look
from ..verdict.outcome import Outcome
from ..verdict.passes import PASSES_SHARE, PassTest
from ..verdict.sequential import ALL_AGREE, SequentialTest
from ..verdict.verdict import conclude
from .caustics import caustics_in
from .comparison import Comparison
from .course import Course
from .departures import Alternatives
from .interim import BoundAt, Interim
from .meter import Meter
from .pilot import Layout, first_layout, fixed_share, main_layout, time_calls
from .run import Stop
from .search import Search, conclude_causes
from .sides import Renderer, Replicates, Side, room_left_by
from .unsupported import UnsupportedLight, require_pixels, room_beside
from .versions import versions

__all__ = ["CompareOptions", "Comparison", "Renderer", "Side", "compare", "versions"]

# The part of the time that is set aside to seek causes at the last look, where there are departures. Earlier searches take more.
ASIDE_SHARE = 0.05
# A bound is told where it is this part of the one that was told before, or less.
TOLD = 0.9


def compare(
    scene: Scene,
    reference: Replicates,
    candidate: Replicates,
    coverage: Coverage,
    options: CompareOptions,
    progress: Progress = NO_PROGRESS,
    among: Alternatives | None = None,
    left_out: np.ndarray | None = None,
    divisor: int = 1,
    scouted: Scouted | None = None,
    passes: Sequence[Part] = (),
    unsupported: UnsupportedLight | None = None,
) -> Comparison:
    """Render `scene` with both renderers in turns until the comparison is decided.

    Sampling ends when every region is decided, or at a limit of `options`. `coverage` maps a kind of region
    ('material', 'object') to its (name, weights (height, width)) pairs. A first look at a few small replicates gives a
    first answer and lays out the rest. Once the open regions fill a part of the image, or time
    is short, parts are sampled on.
    `progress` receives the share of the time (or of the replicates) spent, and at each look the bound and an Interim.
    Cancelling keeps what both sides finished. Where regions differ, the causes are sought `among` departures, in time
    set aside for it, and sampling goes on until they are found or ruled out. Pixels (height, width) that are `left_out`
    belong to no region, nor do those whose paths meet an unknown material. `divisor` is how many times narrower and
    lower the image is than the user's. `scouted` is light that path tracing can hardly find. `passes` are the light
    passes to compare, which the images of both renderers must have. `unsupported` is what materials may add that are
    black in the reference; its pixels are left out, and claims on the others leave room for it. Raises EtalonError
    where nothing was finished, no pixel is left, the images differ in size, or `passes` come with `unsupported`.
    """
    if unsupported is not None and passes:
        raise EtalonError(
            f"{scene.name}: light passes cannot be compared beside unsupported materials; leave out --passes"
        )
    loop = _Loop(scene, (reference, candidate), options, progress, among, scouted, passes)
    loop.unsupported = unsupported
    loop.time_calls()
    loop.lay_out(coverage, left_out)
    while loop.stopped is None:
        loop.render_round()
        if loop.is_look_due():
            loop.test_regions()
            loop.begin_main_run()
            loop.choose_part()
    return loop.conclude(loop.stopped, divisor)


class _Loop:
    """One comparison under way; `compare` calls its methods in the order of the file."""

    def __init__(
        self,
        scene: Scene,
        renderers: tuple[Replicates, Replicates],
        options: CompareOptions,
        progress: Progress,
        among: Alternatives | None,
        scouted: Scouted | None,
        passes: Sequence[Part],
    ) -> None:
        self._started = datetime.now(UTC).isoformat(timespec="seconds")
        self._scene, self._renderers, self._options = scene, renderers, options
        self._seeks_causes = among is not None
        self._among = among if among is not None and among.departures else None
        self._meter = Meter(options, progress, ASIDE_SHARE if self._among else 0.0)
        self._scouted, self._asked = scouted, tuple(passes)
        self._history: list[BoundAt] = []
        # Replicates rendered before those that count now, by the first look.
        self._before = 0
        self.stopped: Stop | None = None
        self.unsupported: UnsupportedLight | None = None

    def time_calls(self) -> None:
        """Measure what samples cost, and lay out the first look; or take the user's samples."""
        asked = self._options.samples
        shape = (self._scene.camera.height, self._scene.camera.width)
        self._timings = None
        if asked is None:
            try:
                self._timings = time_calls(self._renderers, self._meter)
            except Cancelled as cancelled:
                raise self._nothing_to_compare() from cancelled
            self._layout = first_layout(shape, self._timings, self._meter)
        else:
            pair = (asked, asked) if isinstance(asked, int) else asked
            most = self._options.replicates
            self._layout = Layout(pair, (BLOCK,), EXPECTED_LOOKS if most is None else count_looks(most))
        self._is_first = asked is None
        self._pilot_seconds = self._meter.elapsed

    def lay_out(self, coverage: Coverage, left_out: np.ndarray | None) -> None:
        """Set up what does not depend on the layout, and the first run."""
        size = (self._scene.camera.height, self._scene.camera.width)
        self._coverage = {kind: list(named) for kind, named in coverage.items()}
        if self.unsupported is not None:
            left_out = self.unsupported.left_out if left_out is None else left_out | self.unsupported.left_out
        self._compared = None if left_out is None else require_pixels(self._scene, left_out)
        self._left_out = np.zeros(size, bool) if left_out is None else left_out
        self._excluded = np.zeros(size, bool)
        self._begin(self._layout)

    def _begin(self, layout: Layout) -> None:
        """Set up regions, both sides and the test, before anything that counts is rendered."""
        self._layout = layout
        self._meter.progress.begin("first look" if self._is_first else "rendering")
        self._is_last, self._told = False, math.inf
        height, width = self._left_out.shape
        self._regions = image_regions(height, width, self._coverage, layout.blocks, self._compared)
        self._caustics = caustics_in(self._scouted, self._regions) if self._scouted is not None else None
        reference, candidate = (
            Side.empty(renderer, self._regions, samples, self._asked)
            for renderer, samples in zip(self._renderers, layout.samples, strict=True)
        )
        self._sides = reference, candidate
        for side in self._sides:
            side.exclude(self._excluded | self._left_out, None)
        of_passes = PASSES_SHARE if self._asked else 0.0
        of_causes, options = ATTRIBUTION_SHARE - of_passes, self._options
        # With passes or without, so that claims on the image are the same.
        held_back = ATTRIBUTION_SHARE if self._among else PASSES_SHARE
        self._pass_test = None
        if self._asked:
            of_named = self._regions.named.families
            self._pass_test = PassTest(self._asked, of_named, options.tolerance, options.confidence, layout.looks)
        self._test = SequentialTest(
            len(self._regions), options.tolerance, options.confidence, held_back, self._regions.families, layout.looks
        )
        self._search = Search(self._among, self._test, self._meter, self._regions, of_causes) if self._among else None
        # What is sampled on, and whether that is for causes; the work that was done when they were sought last.
        self._open, self._is_searching, self._searched = np.ones(len(self._regions), bool), False, 0.0
        fixed = 0.0 if self._timings is None else fixed_share(self._timings, layout.samples)
        self._course = Course(self._regions, self._sides, self._test, self._meter, options, fixed)

    def render_round(self) -> None:
        """Add one replicate to each side; one that is cancelled or cut short is not kept."""
        course, windows = self._course, self._course.windows
        weight, number = course.weigh(), COUNTED.number(self._before + course.drawn)
        for k, (side, renderer) in enumerate(zip(self._sides, self._renderers, strict=True)):
            try:
                rendering, spent = self._meter.render_counted(renderer, number, weight * side.film.samples, windows)
            except Cancelled:
                break
            if self._timings is not None and windows is None:
                self._timings[k].add(side.film.samples, spent)
            self._excluded = self._excluded | nonfinite_pixels(rendering, self._regions.shape)
            if rendering.unknown is not None:
                self._left_out = require_pixels(self._scene, self._left_out | (rendering.unknown > 0))
            course.exclude(self._excluded | self._left_out)
            side.add(rendering, course.part.of, weight)
            del rendering  # not while the other side renders
        else:
            course.count(weight)
        if not self._sides[1].replicates:
            raise self._nothing_to_compare()

    def is_look_due(self) -> bool:
        """Whether the test is to look at what there is, and whether sampling ends with that look."""
        course = self._course
        n, part = course.replicates, course.part
        # How fast parts come depends on what was seen elsewhere, and so does the time left once that set aside is overdrawn: then, time
        # decides neither when to look nor what a look may spend.
        timely = not course.is_split and not self._meter.is_overdrawn
        after = n if course.is_planned else next_look(n)
        most = None if self._is_first else self._options.replicates
        self.stopped = self._meter.why_stop(n, n + 1 if timely else part.target if n < part.target else after, most)
        self._is_last = self.stopped is Stop.REPLICATES or (self.stopped is not None and timely)
        return course.is_at_look or self._is_last

    def test_regions(self) -> None:
        """Look at the regions of the part, and seek the causes of those that differ."""
        of_reference, of_candidate = (side.regions.moments for side in self._sides)
        self._test.fix_floor(of_reference)
        missing = self.unsupported, self._sides[0].regions, self._test.floor
        room = self._room_for_rare_light(), *room_beside(*missing)
        self._test.look(of_reference, of_candidate, self._is_last, *room, self._course.part.of)
        if self._pass_test is not None:
            passes = self._sides[0].passes, self._sides[1].passes
            self._pass_test.look(*passes, self._layout.samples, self._test.floor, self._is_last)
        bound = BoundAt(self._meter.elapsed, self._sides[1].replicates, self._test.overall_bound(), self._is_first)
        self._history.append(bound)
        if not bound.bound > TOLD * self._told:
            self._told = bound.bound
            self._meter.progress.tell(_describe(bound))
        self._meter.progress.show(self._interim(bound))
        # While nothing differs, all agree together; beside what differs, each other region has to be shown to agree on its own.
        differs = bool((self._test.outcomes == Outcome.DIFFERENT).any())
        # Once parts are sampled, time decides neither when to look nor what a look may spend: what is kept for causes may be used.
        self._meter.keeps_aside = differs or not self._course.is_split
        self._open = self._test.undecided & (~self._test.within | differs)
        # Of the first look, only where no main run follows and one pair of images is a small part of the time.
        may_search = not self._is_first or (self._is_last and bound.replicates >= FIRST_LOOK)
        # Parts come to looks more often; causes are sought after as much more work as there is between looks at the whole image.
        is_due = self._is_last or self._course.work >= GROWTH * self._searched
        if self._search is not None and may_search and is_due:
            self._searched = self._course.work
            differing = frozenset() if self._pass_test is None else self._pass_test.differing
            excluded = self._excluded | self._left_out
            self._is_searching = self._search.look(self._sides, excluded, self._is_last, differing)
        if self._is_searching:
            self._open = self._test.outcomes != Outcome.EQUIVALENT
        elif self._search is not None and self._search.complete:
            self._open = np.zeros_like(self._open)
        self._open = self._open & (self._sides[0].regions.sizes > 0) & ~self._test.blocked

    def _interim(self, bound: BoundAt) -> Interim:
        test = self._test
        return Interim(
            bound, *self._sides, self._regions, test.outcomes, test.floor, self._options.tolerance, self._left_out
        )

    def _room_for_rare_light(self) -> np.ndarray:
        """The relative difference (K,) that light may make which no sample has met."""
        cells = self._regions.families == self._regions.families.max()
        level = ALL_AGREE * self._test.level
        bare = False if self._caustics is None else self._caustics.bare
        room, least = room_left_by((self._sides[0], self._sides[1]), cells, level, bare)
        if self._caustics is None:
            return room
        mean = self._sides[0].regions.moments.mean
        return np.maximum(room, self._caustics.room(mean, self._test.floor, least, level))

    def begin_main_run(self) -> None:
        """Begin anew with larger replicates and finer grids, or go on with the first look."""
        if self._timings is None or not self._is_first or self.stopped is not None:
            return
        self._is_first = False
        sides = self._sides[0].regions, self._sides[1].regions
        left = self._meter.left - (self._meter.seconds_aside or 0.0)
        options = self._options
        layout = main_layout(
            self._layout,
            sides,
            self._timings,
            (left, options.replicates),
            options.tolerance,
            self._test.looks[-1].level,
        )
        self._pilot_seconds = self._meter.elapsed
        if layout is not None:
            self._before += self._course.drawn
            self._begin(layout)
            return
        self._meter.progress.begin("rendering")
        if options.replicates is not None and self._sides[1].replicates >= options.replicates:
            self.stopped = Stop.REPLICATES

    def choose_part(self) -> None:
        """Choose what is rendered until the next look; end where there is nothing."""
        if self.stopped is None and self._test.looks:
            self.stopped = self._course.go_on(self._open)

    def conclude(self, stopped: Stop, divisor: int) -> Comparison:
        """The verdict, and all that it rests on."""
        nonfinite = {side.name: int((side.film.nonfinite > 0).sum()) for side in self._sides}
        explanation = conclude_causes(self._search, self._test, self._sides) if self._seeks_causes else None
        reference, candidate = (side.regions for side in self._sides)
        verdict = conclude(self._test, reference, candidate, nonfinite, self._layout.samples, explanation)
        return Comparison(
            scene=self._scene.name,
            options=self._options,
            reference=self._sides[0],
            candidate=self._sides[1],
            regions=self._regions,
            excluded=self._excluded,
            verdict=verdict,
            explanation=explanation,
            stopped=stopped,
            started=self._started,
            seconds=self._meter.elapsed,
            pilot_seconds=self._pilot_seconds,
            round_seconds=self._course.seconds_to_double(self._open) / max(candidate.moments.most, 1),
            versions=versions(),
            left_out=self._left_out,
            unknown={material.name: material.unknown for material in self._scene.materials if material.unknown},
            blender=self._scene.blender,
            history=tuple(self._history),
            caustics=self._caustic_shares(),
            divisor=divisor,
            passive=self.unsupported is not None,
            passes=self._pass_test and self._pass_test.conclude(*(side.passes for side in self._sides)),
        )

    def _caustic_shares(self) -> np.ndarray | None:
        if self._caustics is None:
            return None
        return self._caustics.share(self._sides[0].regions.moments.mean, self._test.floor)

    def _nothing_to_compare(self) -> EtalonError:
        return EtalonError(f"{self._scene.name}: cancelled before both sides had an image; there is nothing to compare")


def _describe(bound: BoundAt) -> str:
    """What is known so far, in one line."""
    if not math.isfinite(bound.bound):
        return f"no bound after {format_duration(bound.seconds)}"
    where = "on a coarse grid" if bound.first else "everywhere"
    return f"within {format_bound(bound.bound)} {where} after {format_duration(bound.seconds)}"
