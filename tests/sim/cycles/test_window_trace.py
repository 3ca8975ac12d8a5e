import numpy as np
import pytest

from splatline.contract.presets import PLANE, RGB24, SWIFT
from splatline.sim import golden
from splatline.sim.cycles.cycles import count_cycles
from splatline.sim.cycles.window_trace import trace_window
from tests.support.scene_frames import scene_frame


@pytest.mark.parametrize("config", [RGB24, PLANE], ids=lambda config: config.name)
def test_the_window_goes_down_with_the_elements(config):
    frame = scene_frame("knot", view={"size": (96, 96)}, config=config)
    trace = trace_window(frame)
    assert len(trace.top) == count_cycles(frame, after_reset=False)
    assert trace.element[0] == -1
    assert trace.element[-1] == len(frame.codewords) - 1
    for steps in trace:
        assert (np.diff(steps[:-2]) >= 0).all()
    inside = trace.top < frame.height
    assert (trace.oldest[inside] <= np.maximum(trace.top[inside], 0)).all()
    assert (trace.top - trace.oldest)[inside].max() < config.window_lines


def test_the_top_is_the_first_line_of_an_element_once_it_is_drawn():
    frame = scene_frame("knot", view={"size": (96, 96)}, config=RGB24)
    trace = trace_window(frame)
    fields = golden.decode(frame.codewords, frame.config)
    lines = np.cumsum(np.where(fields["control"], fields["x"], 0).astype(int)) - 4
    drawn = (trace.element >= 0) & (trace.element < len(frame.codewords) - 1)
    assert (trace.top[drawn] <= lines[trace.element[drawn]]).all()
    assert set(lines[~fields["control"]]) <= set(trace.top)


def test_blocks_are_not_traced():
    with pytest.raises(ValueError, match="tiles"):
        trace_window(scene_frame("knot", view={"size": (96, 96)}, config=SWIFT))
