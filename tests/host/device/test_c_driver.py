"""The C driver: freestanding, without a warning for any engine, and right on a simulated device."""

import ctypes as c
import shutil
import subprocess

import numpy as np
import pytest

from splatline.contract.beat_layout import raster_stream_bytes
from splatline.contract.codeword_layout import codeword_stream_bytes
from splatline.contract.presets import PAPER, PLANE, PRESETS
from splatline.contract.raster_beats import to_beats
from splatline.contract.register_map import register_map
from splatline.contract.variants import CONFIGS
from splatline.flow.register_texts import c_header
from splatline.host.device.c import DRIVER
from splatline.host.device.device import DeviceTimeoutError
from splatline.plots.figure import rgb_levels
from splatline.sim import golden
from splatline.sim.cosim.axi.axi_device import SimulatedDevice
from tests.rtl.bus.axi_cases import HEIGHT, WIDTH, clean
from tests.support.random_frames import random_raster

FLAGS = [
    *("-std=c99", "-ffreestanding", "-fno-builtin", "-O1"),
    *("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"),
]
OK, NO_ENGINE, OTHER_VERSION, OTHER_ENGINE, BAD_ARGUMENT, REFUSED, STREAM_FAILED, NO_ROOM = range(8)
LIMBS = c.POINTER(c.c_uint64)
READ = c.CFUNCTYPE(c.c_uint32, c.c_void_p, c.c_uint32)
WRITE = c.CFUNCTYPE(None, c.c_void_p, c.c_uint32, c.c_uint32)
SEND = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_int, LIMBS, c.c_size_t)
RECEIVE = c.CFUNCTYPE(c.c_int, c.c_void_p, LIMBS, c.c_size_t, c.POINTER(c.c_size_t))


class Bus(c.Structure):
    _fields_ = [
        ("context", c.c_void_p), ("read32", READ), ("write32", WRITE), ("send", SEND),
        ("receive", RECEIVE),
    ]  # fmt: skip


class Engine(c.Structure):
    _fields_ = [("bus", c.POINTER(Bus)), ("errors", c.c_uint32)]


class Material(c.Structure):
    _fields_ = [("diffuse", c.c_uint32 * 3), ("specular", c.c_uint32 * 3)]


class Counters(c.Structure):
    names = ("frames", "elements", "cycles", "input_stalls", "output_stalls", "words")
    _fields_ = [(name, c.c_uint32) for name in names]


def compiled(config, folder, *flags, output="driver.so"):
    """Compile the driver for a configuration."""
    (folder / "splatline.h").write_text(c_header(register_map(config)))
    for source in DRIVER:
        shutil.copy(source, folder)
    compiler = shutil.which("gcc") or shutil.which("cc")
    command = [compiler, *FLAGS, *flags, "splatline_driver.c", "-o", output]
    subprocess.run(command, cwd=folder, check=True)
    return folder / output


@pytest.mark.parametrize("config", CONFIGS.values(), ids=lambda config: config.name)
def test_it_compiles_for_every_engine_without_a_warning_and_needs_no_library(config, tmp_path):
    built = compiled(config, tmp_path, "-c", output="driver.o")
    undefined = subprocess.run(["nm", "-u", built], capture_output=True, text=True, check=True)
    # GCC's own: a freestanding program has it (GCC manual, 2.1).
    assert set(undefined.stdout.split()) <= {"U", "memset"}


class DeviceBus(Bus):
    """The four functions of a bus, on a device."""

    stop_after = None
    """Cycles after which the link stops within a packet of code words."""

    def __init__(self, device):
        self.device = device
        super().__init__(
            None,
            READ(lambda _, offset: device.read32(offset)),
            WRITE(lambda _, offset, value: device.write32(offset, value)),
            SEND(self.send_packet),
            RECEIVE(self.receive_packet),
        )

    def send_packet(self, _, stream, limbs, count):
        words = np.ctypeslib.as_array(limbs, (count,)).copy()
        self.device.command("send", ("codewords", "initial")[stream], words.tobytes(), None)
        if self.stop_after is not None:
            self.device.command("stall", 0.0, 0)
            self.device.command("wait", self.stop_after)
            self.device.command("pause", "codewords", True)
        return 0

    def receive_packet(self, _, limbs, room, count):
        try:
            beats = self.device.receive().ravel()
        except DeviceTimeoutError:
            return 1
        count[0] = len(beats)
        np.ctypeslib.as_array(limbs, (room,))[: len(beats)] = beats[:room]
        return 0


class Program:
    """What a program does with the driver."""

    def __init__(self, library, device, config):
        self.call, self.config, self.bus, self.engine = library, config, DeviceBus(device), Engine()
        self.opened = library.splatline_open(c.byref(self.engine), c.byref(self.bus))

    def __getattr__(self, name):
        return lambda *values: getattr(self.call, f"splatline_{name}")(
            c.byref(self.engine), *values
        )

    def write(self, frame):
        """Write the tables and the size of a frame."""
        told = [self.set_size(frame.width, frame.height)]
        tables = frame.tables
        for index, (diffuse, specular) in enumerate(
            zip(tables.diffuse.tolist(), tables.specular.tolist(), strict=True)
        ):
            material = Material((c.c_uint32 * 3)(*diffuse), (c.c_uint32 * 3)(*specular))
            told.append(self.set_material(index, c.byref(material)))
        told.append(self.set_ambient((c.c_uint32 * 3)(*tables.ambient.tolist())))
        assert told == [OK] * len(told)

    def draw_words(self, codewords, initial=None, room=4000):
        """Draw; return the status and the beats."""
        limbs = raster_stream_bytes(self.config) // 8
        beats, count = np.zeros((room, limbs), np.uint64), c.c_size_t()
        wide = None
        if initial is not None:
            wide = np.zeros((len(initial), limbs), np.uint64)
            wide[:, : initial.shape[1]] = initial
        words = np.ascontiguousarray(codewords)
        status = self.draw(
            words.ctypes.data_as(LIMBS),
            c.c_size_t(len(words)),
            None if wide is None else wide.ctypes.data_as(LIMBS),
            c.c_size_t(0 if wide is None else len(wide)),
            beats.ctypes.data_as(LIMBS),
            c.c_size_t(room),
            c.byref(count),
        )
        return status, beats[: count.value]

    def expand(self, beats, width, height, background=0x1F1A17, stride=WIDTH + 3):
        """Return the pixels of beats: shape (height, width, 3), uint8."""
        pixels = np.full((height, stride), 0x5A5A5A5A, np.uint32)
        flat = np.ascontiguousarray(beats)
        self.call.splatline_expand(
            flat.ctypes.data_as(LIMBS), c.c_size_t(len(flat)), width, height, background,
            pixels.ctypes.data_as(c.c_void_p), c.c_size_t(stride),
        )  # fmt: skip
        assert (pixels[:, width:] == 0x5A5A5A5A).all()
        return pixels[:, :width].copy().view(np.uint8).reshape(height, width, 4)[..., :3]


def picture(raster):
    """Golden's picture as 8-bit RGB, on the driver's background."""
    return rgb_levels(raster.to_rgb((0x17 / 255, 0x1A / 255, 0x1F / 255)))


@pytest.fixture(scope="module", params=[PAPER, PLANE], ids=lambda config: config.name)
def program(request, tmp_path_factory):
    config = request.param
    path = compiled(config, tmp_path_factory.mktemp("driver"), "-shared", "-fPIC")
    with SimulatedDevice(config, limit=5000, stall=0.2) as device:
        yield Program(c.CDLL(str(path)), device, config)


def test_frames_are_golden_s_from_background_and_from_a_raster(program):
    config = program.config
    assert program.opened == OK
    assert codeword_stream_bytes(config) == (16 if config.plane else 8)
    program.clear_counters()
    for seed, share in enumerate((None, 0.3, None)):
        frame = clean(config, seed, 90)
        program.write(frame)
        start = None
        if share is not None:
            start = random_raster(np.random.default_rng(4), WIDTH, HEIGHT, share, config)
        status, beats = program.draw_words(
            frame.codewords, None if start is None else to_beats(start)
        )
        assert status == OK
        expected = golden.render(frame, start)
        assert expected.drawn.any()
        drawn = program.expand(beats, WIDTH, HEIGHT)
        np.testing.assert_array_equal(drawn, picture(expected))
    counted = Counters()
    program.read_counters(c.byref(counted))
    assert counted.frames == 3
    assert counted.cycles > counted.elements > 200


def test_what_is_wrong_is_said_and_the_next_frame_is_right(program):
    config = program.config
    frame = clean(config, 9, 60)
    program.write(frame)
    assert program.set_size(0, 1) == BAD_ARGUMENT
    assert program.set_size(1, config.max_height + 1) == BAD_ARGUMENT
    assert program.set_material(1 << config.material_bits, c.byref(Material())) == BAD_ARGUMENT
    large = Material((c.c_uint32 * 3)(0, 0, 1 << config.coefficient_bits))
    assert program.set_material(0, c.byref(large)) == BAD_ARGUMENT
    assert program.draw_words(frame.codewords[:0])[0] == BAD_ARGUMENT

    # Without its end word: the engine puts one in, and says so.
    status, beats = program.draw_words(frame.codewords[:-1])
    assert status == REFUSED
    early = register_map(config)["ERROR"]["FRAME_ENDED_EARLY"].mask
    assert program.engine.errors == early
    np.testing.assert_array_equal(
        program.expand(beats, WIDTH, HEIGHT), picture(golden.render(frame))
    )
    whole = len(to_beats(golden.render(frame)))
    status, beats = program.draw_words(frame.codewords, room=whole - 5)
    assert (status, len(beats)) == (NO_ROOM, whole - 5)
    status, beats = program.draw_words(frame.codewords, room=whole)
    assert (status, len(beats)) == (OK, whole)
    np.testing.assert_array_equal(
        program.expand(beats, WIDTH, HEIGHT), picture(golden.render(frame))
    )


def test_a_picture_that_comes_late_is_aborted_and_the_next_frame_is_right(program):
    """The link stops within the packet of code words; what is left of it comes later."""
    frame = clean(program.config, 10, 60)
    program.write(frame)
    program.bus.stop_after = 40
    status, beats = program.draw_words(frame.codewords)
    program.bus.stop_after = None
    assert (status, len(beats)) == (STREAM_FAILED, 0)
    program.bus.device.command("pause", "codewords", False)
    program.bus.device.command("stall", 0.2, 1)
    status, beats = program.draw_words(frame.codewords)
    assert status == OK
    np.testing.assert_array_equal(
        program.expand(beats, WIDTH, HEIGHT), picture(golden.render(frame))
    )


@pytest.mark.parametrize("limbs", [0, 1, 3, 4])
def test_a_packet_without_its_end_is_a_failure(program, monkeypatch, limbs):
    """A DMA that gives a part of the picture, or half a beat, and says that all is well."""
    frame = clean(program.config, 12, 60)
    program.write(frame)
    receive, cut = program.bus.device.receive, []

    def short():
        beats = receive()
        if not cut:
            cut.append(beats)
            return beats.ravel()[:limbs]
        return beats[:0]

    monkeypatch.setattr(program.bus.device, "receive", short)
    status, beats = program.draw_words(frame.codewords)
    assert (status, len(beats)) == (STREAM_FAILED, 0)
    monkeypatch.undo()
    assert program.draw_words(frame.codewords)[0] == OK


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"ID": 1}, NO_ENGINE),
        ({"VERSION": 0x7F00}, OTHER_VERSION),
        ({"CONFIG_0": 0}, OTHER_ENGINE),
        ({"CONFIG_1": 0}, OTHER_ENGINE),
        ({}, OK),
    ],
)
def test_another_engine_is_refused_and_nothing_is_written(change, status, tmp_path):
    registers = register_map(PRESETS["rgb24"])
    values = {
        register.offset: sum(
            field.mask & (field.reset or 0) << field.place.lsb for field in register.fields
        )
        for register in registers.registers
    }
    values |= {registers[name].offset: value for name, value in change.items()}
    written = []

    class Memory:
        def read32(self, offset):
            return values[offset]

        def write32(self, offset, value):
            written.append(offset)

    library = c.CDLL(str(compiled(PRESETS["rgb24"], tmp_path, "-shared", "-fPIC")))
    assert Program(library, Memory(), PRESETS["rgb24"]).opened == status
    assert bool(written) == (status == OK)
