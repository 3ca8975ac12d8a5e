"""Frames under way are counted."""

from splatline.view.unshown import Unshown


def test_two_frames_are_under_way_at_most():
    unshown = Unshown()
    assert unshown.are_few
    unshown.note_sent(1)
    assert unshown.are_few
    unshown.note_sent(2)
    assert not unshown.are_few
    unshown.note_shown(1)
    assert unshown.are_few


def test_the_two_pictures_of_a_split_are_one_frame():
    unshown = Unshown()
    unshown.note_sent(1)
    unshown.note_sent(1)
    assert unshown.are_few


def test_an_acknowledgement_of_an_old_frame_or_of_none_changes_nothing():
    unshown = Unshown()
    for frame in range(1, 5):
        unshown.note_sent(frame)
        unshown.note_shown(frame)
    unshown.note_shown(1)
    assert unshown.are_few
    unshown.note_shown(99)
    unshown.note_sent(5)
    unshown.note_sent(6)
    assert not unshown.are_few
