import pytest

from splatline.contract.presets import PLANE
from splatline.flow.stream_texts import json_beat, json_codeword
from splatline.flow.tops import TOPS


@pytest.mark.parametrize("top", TOPS)
def test_the_description_of_every_top_has_its_stream_words(top):
    _, described = TOPS[top](PLANE, "splatline")
    assert described["codeword"] == json_codeword(PLANE)
    assert described["beat"] == json_beat(PLANE)
