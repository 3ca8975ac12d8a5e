"""Table writes: what they reach, and when they are taken."""

import random

import cocotb

from splatline.contract.fields import Register
from splatline.contract.presets import PAPER
from splatline.rtl.front.tables import MaterialWriteLayout, RegistersLayout, Tables
from splatline.sim.cosim.blocks import run_bench, unpack
from splatline.sim.cosim.streams import StreamBench

REGISTERS, MATERIAL = RegistersLayout(PAPER), MaterialWriteLayout(PAPER)
BASE = PAPER.register_base


def write(address, data):
    return address << PAPER.table_address.lsb | data


@cocotb.test()
async def each_register_has_its_address(dut):
    """Random writes reach their register alone; other addresses reach nothing."""
    rng = random.Random(1)
    bits = {
        BASE + Register.AMBIENT_RED: ("ambient", 0, 14),
        BASE + Register.AMBIENT_GREEN: ("ambient", 1, 14),
        BASE + Register.AMBIENT_BLUE: ("ambient", 2, 14),
        BASE + Register.LAST_COLUMN: ("last_column", None, 9),
        BASE + Register.LAST_LINE: ("last_line", None, 10),
        BASE + Register.CONTROL: ("load", None, 1),
    }
    bench = StreamBench(dut, 1)
    source = bench.source("i", [])
    dut.idle.value = 1
    await bench.reset()
    state = {"ambient0": 0, "ambient1": 0, "ambient2": 0}
    state |= {"last_column": 511, "last_line": 511, "load": 0}
    for _ in range(600):
        address = rng.choice([*bits, *range(BASE + 6, 256, 31), *range(0, 128, 17)])
        data = rng.getrandbits(36)
        source.payloads, source.sent = [write(address, data)], 0
        seen = {}

        def observe(seen=seen):
            seen["material"] = int(dut.material.value)

        await bench.step(observe=observe)
        if address in bits:
            name, index, width = bits[address]
            state[name if index is None else f"{name}{index}"] = data & (1 << width) - 1
        registers = unpack(REGISTERS, int(dut.registers.value))
        found = {f"ambient{c}": registers.ambient[c] for c in range(3)}
        found |= {name: getattr(registers, name) for name in ("last_column", "last_line", "load")}
        assert found == state, hex(address)
        material = unpack(MATERIAL, seen["material"])
        assert material.enable == (address < BASE)
        if address < BASE:
            assert (material.address, material.data) == (address, data)


@cocotb.test()
async def nothing_is_taken_while_a_frame_is_open(dut):
    """A write waits for the engine to be idle, and reaches nothing meanwhile."""
    bench = StreamBench(dut, 2)
    source = bench.source("i", [write(BASE + Register.LAST_LINE, 99), write(5, 1)])
    dut.idle.value = 0
    await bench.reset()
    for _ in range(10):
        await bench.step()
        assert not unpack(MATERIAL, int(dut.material.value)).enable
    assert source.sent == 0
    assert unpack(REGISTERS, int(dut.registers.value)).last_line == 511
    await bench.step(lambda: setattr(dut.idle, "value", 1))
    assert source.sent == 1
    assert unpack(REGISTERS, int(dut.registers.value)).last_line == 99


def test_table_writes_reach_their_place(block_simulator):
    run_bench(Tables(PAPER), __file__, simulator_name=block_simulator)
