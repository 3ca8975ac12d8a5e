"""The write channels of AXI4."""

from __future__ import annotations

from enum import IntEnum

from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["ADDRESS_BITS", "AxiWriteSignature", "Burst"]

ADDRESS_BITS = 32
"""Bits of an address."""


class Burst(IntEnum):
    """Types of a burst (Arm IHI 0022, "Burst type")."""

    FIXED = 0
    INCR = 1
    WRAP = 2


class AxiWriteSignature(wiring.Signature):
    """The channels AW, W and B of AXI4, as the master sees them.

    An ID has one bit, which most interconnects ask for.

    Parameters
    ----------
    data_bits
        Bits of WDATA.
    """

    def __init__(self, data_bits: int):
        self.data_bits = data_bits
        super().__init__(
            {
                "awid": Out(1),
                "awaddr": Out(ADDRESS_BITS),
                "awlen": Out(8),
                "awsize": Out(3),
                "awburst": Out(2),
                "awlock": Out(1),
                "awcache": Out(4),
                "awprot": Out(3),
                "awqos": Out(4),
                "awvalid": Out(1),
                "awready": In(1),
                "wdata": Out(data_bits),
                "wstrb": Out(data_bits // 8),
                "wlast": Out(1),
                "wvalid": Out(1),
                "wready": In(1),
                "bid": In(1),
                "bresp": In(2),
                "bvalid": In(1),
                "bready": Out(1),
            }
        )
