# SPDX-License-Identifier: GPL-3.0-or-later
"""What is set of the interpreter while tiles are traced comes back, whatever happened."""

import sys

import pytest
from etalon.lib.errors import Cancelled
from etalon.lib.progress import Progress
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.lib.wavefront.turns import INTERVAL
from etalon.tests.scenes import diffuse, floor, perspective, scene

ROOM = scene(floor(2.0, 0.0), diffuse(0.5), perspective(4, 4, 0.8, (0.0, 0.0, 3.0), (0.0, 0.0, -1.0)))


@pytest.mark.parametrize("stop", [False, True])
def test_the_interval_comes_back(stop):
    own = sys.getswitchinterval()
    seen = []

    def cancelled():
        seen.append(sys.getswitchinterval())
        return stop

    sys.setswitchinterval(0.00321)
    before = sys.getswitchinterval()
    try:
        if stop:
            with pytest.raises(Cancelled):
                ReferenceRenderer(ROOM).render(0, 1, Progress(is_cancelled=cancelled))
        else:
            ReferenceRenderer(ROOM).render(0, 1, Progress(is_cancelled=cancelled))
        assert sys.getswitchinterval() == before
    finally:
        sys.setswitchinterval(own)
    assert seen == pytest.approx([INTERVAL] * len(seen))
