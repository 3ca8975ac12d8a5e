"""The driver on files that stand for a board; on a simulation it is in test_axi.py."""

import numpy as np
import pytest

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER, PLANE, PRESETS, SWIFT
from splatline.contract.register_map import register_map
from splatline.contract.variants import CONFIGS, NARROW_BLOCKS
from splatline.host.device.device import DeviceLostError, DeviceTimeoutError
from splatline.host.device.driver import Engine, EngineError, read_config
from splatline.host.device.xdma import XdmaDevice
from splatline.sim import golden
from tests.host.device.fake_board import FakeBoard
from tests.rtl.bus.axi_cases import HEIGHT, WIDTH, clean, draw_scene
from tests.support.random_frames import random_raster

ERROR = register_map(PAPER)["ERROR"]


@pytest.fixture
def board(tmp_path, request):
    fake = FakeBoard(tmp_path, getattr(request, "param", PAPER))
    yield fake
    fake.close()


PATIENT = 300.0
"""Seconds of a device that answers, on a machine with much else to do."""


@pytest.mark.parametrize(
    "board", [PAPER, PRESETS["rgb24"], SWIFT, PLANE], indirect=True, ids=lambda c: c.name
)
def test_the_code_of_a_simulation_draws_on_a_board(board):
    rng = np.random.default_rng(1)
    with XdmaDevice(board.card, timeout=PATIENT) as device:
        engine = Engine(device)
        assert engine.config is board.config
        for seed, share in enumerate((None, 0.4, None)):
            frame = clean(board.config, seed)
            start = None
            if share:
                start = random_raster(rng, WIDTH, HEIGHT, share, board.config)
            picture = draw_scene(engine, frame, start)
            assert picture.mismatches(golden.render(frame, start)) == 0


def test_a_frame_longer_than_what_the_pipes_hold(board):
    frame = clean(PAPER, 3, 20_000)
    with XdmaDevice(board.card, timeout=PATIENT) as device:
        assert draw_scene(Engine(device), frame).mismatches(golden.render(frame)) == 0


def test_materials_that_have_not_changed_are_not_written_again(board, monkeypatch):
    frame = clean(PAPER, 4)
    with XdmaDevice(board.card, timeout=PATIENT) as device:
        engine = Engine(device)
        engine.write_tables(frame.tables, WIDTH, HEIGHT)
        written = []
        write = device.write_words
        monkeypatch.setattr(
            device,
            "write_words",
            lambda offset, words: (written.append((offset, len(words))), write(offset, words)),
        )
        frame.tables.diffuse[[5, 77, 78]] ^= 1
        engine.write_tables(frame.tables, WIDTH, HEIGHT)
        start = engine.registers.materials.offset
        assert written == [(start + 8 * 5, 2), (start + 8 * 77, 4)]
        assert engine.draw(frame.codewords).mismatches(golden.render(frame)) == 0


def test_an_error_is_raised_by_name_with_what_was_drawn(board, monkeypatch):
    frame = clean(PAPER, 5)
    with XdmaDevice(board.card, timeout=PATIENT) as device:
        engine = Engine(device)
        engine.write_tables(frame.tables, WIDTH, HEIGHT)
        receive = device.receive

        def with_an_error():
            device.write32(ERROR.offset, ERROR["LINE_PAST"].mask | ERROR["X_OUTSIDE"].mask)
            return receive()

        monkeypatch.setattr(device, "receive", with_an_error)
        with pytest.raises(EngineError, match="X_OUTSIDE: an element beyond") as raised:
            engine.draw(frame.codewords)
        assert raised.value.names == ("X_OUTSIDE", "LINE_PAST")
        assert len(raised.value.beats) > 1


def test_a_raster_that_does_not_end_is_given_up(board):
    with XdmaDevice(board.card, timeout=0.1) as device, pytest.raises(DeviceTimeoutError):
        device.receive()


def test_a_raster_stream_that_ends_is_not_waited_for(tmp_path):
    """A read that returns nothing: as of a card that is taken away."""
    fake = FakeBoard(tmp_path, PAPER)
    with XdmaDevice(fake.card, timeout=60.0) as device:
        fake.close()
        with pytest.raises(DeviceLostError, match="stream has ended"):
            device.receive()


def test_tables_of_another_engine_are_refused(board):
    """Before a register is written: its values do not fit the fields of this one."""
    with (
        XdmaDevice(board.card) as device,
        pytest.raises(InputError, match="values that do not fit"),
    ):
        Engine(device).write_tables(clean(PRESETS["rgb24"], 6).tables, 64, 40)


def test_an_image_larger_than_the_engine_s_is_refused(board):
    frame = clean(PAPER, 6)
    with XdmaDevice(board.card, timeout=PATIENT) as device:
        engine = Engine(device)
        with pytest.raises(InputError, match="513x40 pixels does not fit the engine's 512x1024"):
            engine.write_tables(frame.tables, 513, 40)
        with pytest.raises(InputError, match="at least its end word"):
            engine.draw(frame.codewords[:0])
        with pytest.raises(InputError, match=r"shape \(n,\), not \(3, 2\)"):
            engine.draw(np.zeros((3, 2), np.uint64))
        with pytest.raises(ValueError, match=r"LAST_COLUMN\.VALUE has 9 bits"):
            engine.set("LAST_COLUMN", VALUE=512)


@pytest.mark.parametrize(
    ("name", "word", "message"),
    [
        ("ID", 0, "no Splatline engine: its ID is 0x00000000"),
        ("VERSION", 0x105, "version 1 of the registers, not 2"),
        ("VERSION", 0x300, "version 3 of the registers, not 2"),
        ("CONFIG_0", 0, "configuration makes no sense: x_bits must be"),
    ],
)
def test_what_is_no_engine_is_refused(board, name, word, message):
    image = bytearray(board.memory.read_bytes())
    offset = board.offsets[name]
    image[offset : offset + 4] = word.to_bytes(4, "little")
    board.memory.write_bytes(image)
    with pytest.raises(InputError, match=message):
        XdmaDevice(board.card)


def test_planes_in_registers_of_version_2_are_refused():
    registers = Registers(PLANE)
    registers.words[register_map(PLANE)["VERSION"].offset] = 0x200
    with pytest.raises(InputError, match="version 2 of the registers, not 3"):
        read_config(registers)


def test_slopes_that_no_engine_has_are_refused():
    registers = Registers(PLANE)
    register = register_map(PLANE)["CONFIG_1"]
    registers.words[register.offset] |= register["SLOPE_BITS"].mask
    with pytest.raises(InputError, match=r"makes no sense: slope_bits must be .* 3\.\.8, not 15"):
        read_config(registers)


def test_files_that_are_not_there_are_named(tmp_path):
    with pytest.raises(InputError, match=r"xdma7_user: No such file.*driver loaded"):
        XdmaDevice(str(tmp_path / "xdma7"))
    (tmp_path / "xdma7_user").write_bytes(b"")
    with pytest.raises(InputError, match="xdma7_user: cannot be mapped"):
        XdmaDevice(str(tmp_path / "xdma7"))


class Registers:
    """Registers that read as their reset values."""

    def __init__(self, config):
        self.words = {
            register.offset: sum(field.reset << field.place.lsb for field in register.fields)
            for register in register_map(config).registers
        }

    def read32(self, offset):
        return self.words[offset]


def test_a_window_that_does_not_fit_the_rest_is_refused(board):
    """As of a register that was misread: the window of blocks has no words of four pixels."""
    image = bytearray(board.memory.read_bytes())
    place = register_map(PAPER)["CONFIG_0"]["WINDOW"].place
    offset = board.offsets["CONFIG_0"] + place.lsb // 8
    image[offset] |= 1 << place.lsb % 8
    board.memory.write_bytes(image)
    with pytest.raises(InputError, match="no sense: pixels_per_word must be 8 with blocks, not 4"):
        XdmaDevice(board.card)


@pytest.mark.parametrize("config", CONFIGS.values(), ids=lambda config: config.name)
def test_an_engine_s_configuration_is_read_from_its_registers(config):
    assert read_config(Registers(config)) is config
    other = config.replace(coefficient_bits=config.coefficient_bits + 1)
    assert read_config(Registers(other)) == other


def test_an_engine_that_has_no_name_is_read_from_its_registers():
    """Its beats are the widest there are: 663 bits, on a stream of 1024."""
    widest = NARROW_BLOCKS.replace(
        x_bits=12, depth_bits=16, line_bits=14, intensity_bits=1, material_bits=9, colour_shift=11
    )
    assert widest.raster_end.end == 663
    assert raster_stream_bytes(widest) == 128
    narrow = PLANE.replace(slope_bits=3, depth_bits=16)
    for config in (NARROW_BLOCKS.replace(), widest, narrow):
        assert read_config(Registers(config)) == config
