"""Files that a live view gives hold its picture."""

import io
import zipfile

import numpy as np
import pytest
from PIL import Image

from splatline.host.frame_file import load_frame
from splatline.sim.golden.renderer import render
from splatline.view.draw import Settings, draw
from tests.view.views import SIZE, event, set_to


def test_a_picture_is_saved_with_all_samples_also_while_moving(session, live, clock):
    session.queue(set_to("samples", 4))
    session.queue(event("moving", value=True))
    session.queue(event("turn", dx=5, dy=0))
    session.queue(event("save", what="png"))
    saved = session.work()[0]
    assert (saved.name, saved.mime) == ("ball.png", "image/png")
    pixels = np.asarray(Image.open(io.BytesIO(saved.data)))
    drawn = draw(live, session.camera, SIZE, Settings(samples=4))
    assert np.array_equal(pixels, drawn.rgba[..., :3])


@pytest.mark.parametrize(("samples", "size"), [(1, SIZE), (4, SIZE), (1, (600, 80))])
def test_saved_code_words_draw_the_picture(session, live, samples, size, tmp_path):
    session.queue(set_to("samples", samples))
    session.queue(event("resize", width=size[0], height=size[1]))
    session.queue(event("save", what="words"))
    saved = session.work()[0]
    assert saved.mime == "application/zip"
    with zipfile.ZipFile(io.BytesIO(saved.data)) as archive:
        names = sorted(archive.namelist())
        archive.extractall(tmp_path)
    frames = [load_frame(tmp_path / name) for name in names if name.endswith(".frame")]
    drawing = draw(live, session.camera, size, Settings(samples=samples))
    assert len(frames) == len(drawing.frames)
    assert len(names) == 2 * len(frames)
    if size == SIZE:
        for frame, raster in zip(frames, drawing.rasters, strict=True):
            assert render(frame).mismatches(raster) == 0
