"""A board's bus as a dictionary, for tests of the driver without a simulator."""

import numpy as np

from splatline.contract.presets import RGB24
from splatline.contract.register_map import register_map

__all__ = ["DESCRIPTION", "FakeBus"]

NAMES = (
    "ctrl_reset", "ctrl_scratch", "ctrl_bus_errors", "sdram_dfii_control",
    "sdram_dfii_pi0_command", "sdram_dfii_pi0_command_issue", "sdram_dfii_pi0_address",
    "sdram_dfii_pi0_baddress", "scanout_enable", "scanout_left", "scanout_top", "scanout_columns",
    "scanout_lines", "scanout_offset", "scanout_stride", "scanout_buffer_0", "scanout_buffer_1",
    "scanout_background", "scanout_refreshes", "scanout_swaps", "scanout_underruns",
    "player_enable", "player_loop", "player_frames", "player_hold", "player_busy", "player_played",
    "engine_writer_error",
)  # fmt: skip

DESCRIPTION = {
    "preset": "rgb24",
    "clk_freq": 50e6,
    "registers": {name: 4 * n for n, name in enumerate(NAMES)},
    "engine": 0x2_0000,
    "frame_list": 0x1_0000,
    "most_frames": 4,
    "main_ram": 0x4000_0000,
    "main_ram_bytes": 1 << 20,
    "screen": [160, 120],
    "refresh_hz": 60.0,
    "sdram_init": [["control", 0, 0, 14, 20000], ["command", 1024, 0, 11, 0]],
}
"""What a small board tells of itself."""


class FakeBus:
    """A link to a memory with an engine's registers as they are after reset."""

    def __init__(self, config=RGB24):
        self.words = {}
        for register in register_map(config).registers:
            value = sum(field.reset << field.place.lsb for field in register.fields)
            self.words[DESCRIPTION["engine"] + register.offset] = value

    def read(self, address, count=1):
        return np.array([self.words.get(address + 4 * n, 0) for n in range(count)], np.uint32)

    def write(self, address, words):
        for place, value in zip(range(address, address + 4 * len(words), 4), words, strict=True):
            self.words[place] = int(value)

    def value(self, name):
        return self.words.get(DESCRIPTION["registers"][name], 0)
