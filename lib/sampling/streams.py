# SPDX-License-Identifier: GPL-3.0-or-later
"""Every use of random numbers that an image depends on, in one place.

The uses are its replicates, its dimensions and its keys.

A pair of uniforms is named by (seed, replicate, dimension); `stream_key` in sobol.py makes one key of the three. Two
uses are independent if they share no replicate, or no dimension within one. Whoever needs a new use gives it a range
here. Generators that no image sees are seeded where they stand: the bootstrap of a forecast, the timings of model
forms, the places of the stability atlas.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import EtalonError


@dataclass(frozen=True)
class Stream:
    """A range of replicate numbers: `count` of them from `first` on, for one `use`."""

    use: str
    first: int
    count: int

    def number(self, k: int) -> int:
        """Return the replicate number of the stream's `k`-th image, k from 0.

        Raises EtalonError beyond the stream's range.
        """
        if not 0 <= k < self.count:
            raise EtalonError(
                f"{self.use}: there are {self.count} replicates, and number {k} is asked for; "
                "give fewer replicates of more samples"
            )
        return self.first + k


COVERAGE = Stream("what camera rays meet", -1, 1)
COUNTED = Stream(
    "replicates that a film, a comparison, an audit or a level of a cost measurement counts", 0, (1 << 18) - 1
)
VERIFICATION = Stream(
    "the renders that put a cost forecast to the test, a first call before them", (1 << 18) - 1, 1 << 18
)
TRUTH = Stream("the long render that cost measurements compare with", 1 << 19, (1 << 19) - 1)
REACH = Stream("pixels that unsupported materials can affect", (1 << 20) - 1, 1)
FIRST_CALLS = Stream("pilots and first calls: timed, counted nowhere", 1 << 20, 1 << 20)
DEPARTURES = Stream("pairs of images with and without departures, of the reference alone", 1 << 21, 1 << 21)
SCOUTING = Stream("light paths that look for caustics", 1 << 22, 1 << 12)
STAND_INS = Stream("images with stand-ins for unsupported materials", (1 << 22) + (1 << 12), 1 << 6)

STREAMS = (COVERAGE, COUNTED, VERIFICATION, TRUTH, REACH, FIRST_CALLS, DEPARTURES, SCOUTING, STAND_INS)

# Cycles has one seed for an image: numbered replicate first, then chunk of the image's samples. No stream that Cycles renders reaches
# beyond this many replicates.
CYCLES_REPLICATES = 1 << 21

# Dimensions of a path: a pair of uniforms each. Two for the camera, then four for each step along the path.
PIXEL, LENS, FIRST_STEP = 0, 1, 2
BSDF, LIGHT, CHOICES, FATE = 0, 1, 2, 3
DIMENSIONS_PER_STEP = 4
# The wavelength of a path where an index depends on it: beyond every step.
WAVELENGTH = 1 << 30
# When the shutter is open: the moments of a replicate, and a seed for each.
SHUTTER = (1 << 30) + 1

# Dimensions of a path from a light, apart from those of camera paths, which a replicate of light tracing traces too: the emitter, the
# place and the direction in which the ray leaves it, then for each step a lobe and roulette, the direction, the lens, and the chance to pass.
EMITTER, PLACE, HEADING, FIRST_LIGHT_STEP = (k + (1 << 29) for k in range(4))
ADJOINT_CHOICES, ADJOINT_BSDF, ADJOINT_LENS, ADJOINT_FATE = 0, 1, 2, 3

# Walks below surfaces, three pairs for each step of the path: whether and by which closure light enters, how, and a key for the rest.
WALK = 1 << 28
ENTER, ENTRY, WALK_KEY = 0, 1, 2

# Dimensions of a camera path in volumes that scatter, apart from the others: for each step where light is sampled, the light's direction, which
# light and which phase function, where the path scatters, whereto, and roulette.
FIRST_VOLUME_STEP = 1 << 27
VOLUME_PLACE, VOLUME_LIGHT, VOLUME_CHOICES, VOLUME_FLIGHT, VOLUME_PHASE, VOLUME_FATE = range(6)

# Rays of ambient occlusion, a pair for each step of a camera path.
OCCLUSION = 1 << 26

# Keys of the probes of Bevel nodes, a pair for each step of a camera path.
BEVEL = 1 << 25

# Keys beside the dimensions: how pixels pick and shift point sets, the generator of plain random numbers, those of Markov chains, and of the
# samples from which all replicates of chains take one level of brightness.
PIXEL_KEYS, RANDOM_NUMBERS, METROPOLIS, METROPOLIS_PILOT = -2, -1, -3, -4


def step_dimension(step: int, decision: int) -> int:
    """Return the dimension of a `decision` at a step of the path, counted from 0.

    `decision` is BSDF, LIGHT, CHOICES or FATE.
    """
    return FIRST_STEP + DIMENSIONS_PER_STEP * step + decision


def occlusion_dimension(step: int) -> int:
    """Return the dimension of the ray of ambient occlusion at a step of the path, from 0."""
    return OCCLUSION + step


def bevel_dimension(step: int) -> int:
    """Return the dimension of the key of a Bevel node's probes at a step of the path, from 0."""
    return BEVEL + step


def light_step_dimension(step: int, decision: int) -> int:
    """Return the dimension of a `decision` at a step of a path from a light, from 0.

    `decision` is ADJOINT_CHOICES, _BSDF, _LENS or _FATE.
    """
    return FIRST_LIGHT_STEP + DIMENSIONS_PER_STEP * step + decision


def walk_dimension(step: int, decision: int) -> int:
    """Return the dimension of a `decision` about a walk below a surface at a step, from 0.

    `decision` is ENTER, ENTRY or WALK_KEY. The step is that of the path.
    """
    return WALK + 3 * step + decision


def volume_step_dimension(step: int, decision: int) -> int:
    """Return the dimension of a `decision` at a step of a path through volumes, from 0.

    `decision` is VOLUME_PLACE, ...
    """
    return FIRST_VOLUME_STEP + 6 * step + decision
