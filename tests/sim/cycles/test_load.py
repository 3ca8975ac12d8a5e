"""What a dense frame pays for the picture that it leaves, and for the one that it starts from."""

import numpy as np
import pytest

from splatline.contract.presets import get_preset
from splatline.host import load_scene
from splatline.sim import golden
from splatline.sim.cosim.player.frames import Job, play
from tests.support.engines import engine
from tests.support.scene_frames import scene_frame

MOST = 1.035
"""Cycles a code word: no engine takes less than one."""
BEAT = 2
"""Cycles in which no block is drawn as a beat is loaded."""


@pytest.mark.parametrize("preset", ["paper", "rgb24", "swift"])
def test_a_dense_frame_pays_three_hundredths_for_flush_and_load(preset):
    """All words of its own picture are loaded below it; splats are as large as it is spaced.

    In a window of blocks a load takes the place of two blocks, and that comes on top.
    """
    config = get_preset(preset)
    frame = scene_frame("knot", view={"zoom": load_scene("knot").zoom}, config=config)
    picture = golden.render(frame)
    words = picture.drawn.reshape(frame.height, -1, config.raster_pixels).any(axis=-1)
    assert np.count_nonzero(words) > 0.4 * words.size
    (outcome,) = play([Job(frame=frame, initial=picture)], built=engine(config))
    assert not outcome.raster.mismatches(picture)
    loads = BEAT * np.count_nonzero(words) if config.draws_blocks else 0
    assert len(frame.codewords) <= outcome.cycles - loads <= MOST * len(frame.codewords)
