"""What is told of a build or a run while it goes on."""

import threading

import pytest

from splatline.sim.cosim import simulator
from splatline.sim.cosim.watch import share_of, watched


def test_a_share_is_told_from_another_thread_until_the_block_ends():
    told, heard = [], threading.Event()

    def tell(share):
        told.append((share, threading.current_thread()))
        heard.set()

    with watched(lambda: 0.5, tell):
        assert heard.wait(10.0)
    count = len(told)
    assert not any(thread is threading.main_thread() for _, thread in told)
    assert {share for share, _ in told} == {0.5}
    heard.clear()
    assert not heard.wait(0.5)
    assert len(told) == count


def test_what_is_not_there_yet_is_looked_for_again(tmp_path):
    heard = threading.Event()
    looked = []

    def share():
        looked.append(None)
        if len(looked) == 2:
            (tmp_path / "taken").write_text("7")
        return int((tmp_path / "taken").read_text()) / 4

    told = []
    with watched(share, lambda share: (told.append(share), heard.set())):
        assert heard.wait(10.0)
    assert told[0] == 1.0  # never more than all


def test_an_error_in_the_block_ends_the_thread():
    before = threading.active_count()
    with pytest.raises(ValueError, match="stop"), watched(lambda: 0.0, lambda share: None):
        raise ValueError("stop")
    assert threading.active_count() == before


def test_nobody_is_told_where_nobody_asks():
    assert share_of(None, "build") is None
    before = threading.active_count()
    with watched(lambda: 0.0, None):
        assert threading.active_count() == before


def test_a_build_is_shared_by_its_files(tmp_path):
    """Verilator's own file, the five of the libraries, and the design's: one, or its parts."""
    assert simulator._share(tmp_path, parts=False) == 0.0
    (tmp_path / "Vtop.mk").touch()
    assert simulator._share(tmp_path, parts=False) == pytest.approx(1 / 7)
    for name in ("Vtop__0", "Vtop__1", "Vtop__Syms"):
        (tmp_path / f"{name}.cpp").touch()
    assert simulator._share(tmp_path, parts=True) == pytest.approx(1 / 9)
    for name in ("verilator", "verilated_dpi", "verilated", "verilated_threads", "verilated_vpi"):
        (tmp_path / f"{name}.o").touch()
    assert simulator._share(tmp_path, parts=False) == pytest.approx(6 / 7)
    (tmp_path / "Vtop__ALL.o").touch()
    assert simulator._share(tmp_path, parts=False) == 1.0
