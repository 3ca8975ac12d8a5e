"""Description of a board's system: what its driver must know, as plain values for a JSON file."""

from __future__ import annotations

import json

from litedram.init import get_sdram_phy_init_sequence
from litex.soc.integration.export import get_csr_json

from .memory_map import ENGINE, FRAME_LIST, MAIN_RAM
from .player import MOST_FRAMES

__all__ = ["describe"]


def describe(soc, **more) -> dict:
    """Return the description of a system that was finalised.

    Parameters
    ----------
    soc
        A :class:`splatline.boards.soc.BoardSoC`.
    more
        Further values.

    Returns
    -------
    dict
        ``preset``; ``registers``: byte address by name; ``main_ram``, ``main_ram_bytes``;
        ``engine``, ``frame_list``, ``most_frames``; ``screen``: width and height; ``sdram_init``:
        rows of address, bank, command and cycles to wait; ``clk_freq`` in Hz; and ``more``.
    """
    told = json.loads(get_csr_json(csr_regions=soc.csr.regions))["csr_registers"]
    registers = {name: register["addr"] for name, register in told.items()}
    commands = {"CS": 1, "WE": 2, "CAS": 4, "RAS": 8}
    controls = {"CKE": 2, "ODT": 4, "RESET_N": 8}
    sequence, _ = get_sdram_phy_init_sequence(
        soc.sdrphy.settings, soc.sdram.controller.settings.timing
    )
    rows = []
    for _, address, bank, names, cycles in sequence:
        words = [name.removeprefix("DFII_") for name in names.split("|")]
        kind = words[0].split("_")[0]
        values = commands if kind == "COMMAND" else controls
        value = sum(values[word.removeprefix(f"{kind}_")] for word in words)
        rows.append([kind.lower(), address, bank, value, cycles])
    geometry = soc.sdram.controller.settings.geom
    bits = geometry.bankbits + geometry.rowbits + geometry.colbits
    return {
        "preset": soc.config_name,
        "clk_freq": soc.sys_clk_freq,
        "registers": registers,
        "engine": soc.registers + ENGINE,
        "frame_list": soc.registers + FRAME_LIST,
        "most_frames": MOST_FRAMES,
        "main_ram": MAIN_RAM,
        "main_ram_bytes": (1 << bits) * soc.sdrphy.settings.databits // 8,
        "screen": [soc.timings["h_active"], soc.timings["v_active"]],
        "refresh_hz": round(
            soc.timings["pix_clk"]
            / (soc.timings["h_active"] + soc.timings["h_blanking"])
            / (soc.timings["v_active"] + soc.timings["v_blanking"]),
            2,
        ),
        "sdram_init": rows,
        **more,
    }
