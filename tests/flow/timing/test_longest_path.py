import random
from itertools import count

import pytest

from splatline.flow.timing.longest_path import Step, find_longest, signal_names


def cell(kind, out, **inputs):
    """A cell with an output O; inputs by pin, a bit or a constant each."""
    return {
        "type": kind,
        "port_directions": {"O": "output", **dict.fromkeys(inputs, "input")},
        "connections": {"O": [out], **{pin: [bit] for pin, bit in inputs.items()}},
    }


def module(cells):
    return {"cells": dict(cells), "netnames": {}}


def random_module(rng):
    """Registers and LUTs, each LUT fed by what stands before it, in any order."""
    bits = count(1)
    registers = [next(bits) for _ in range(4)]
    known = list(registers)
    cells = []
    for number in range(rng.randint(1, 14)):
        fed = rng.choices([*known, "0"], k=rng.randint(1, 4))
        out = next(bits)
        pins = {f"I{place}": bit for place, bit in enumerate(fed)}
        cells.append((f"lut_{number}", cell(f"LUT{len(fed)}", out, **pins)))
        known.append(out)
    cells += [
        (f"register_{number}", cell("FDRE", bit, C=99, D=rng.choice(known), CE=rng.choice(known)))
        for number, bit in enumerate(registers)
    ]
    rng.shuffle(cells)
    return module(cells)


def every_path(netlist, costs):
    """What each path counts, by going back from each register's inputs on all ways."""
    start, wire, end = costs
    drivers = {found["connections"]["O"][0]: name for name, found in netlist["cells"].items()}

    def back(name, place):
        for pin, (bit,) in netlist["cells"][name]["connections"].items():
            if pin in ("O", "C") or bit not in drivers:
                continue
            before = drivers[bit]
            this = (wire if place else end)[name, pin]
            if before.startswith("register"):
                yield this + start
            else:
                yield from (this + rest for rest in back(before, place + 1))

    return [
        total for name in netlist["cells"] if name.startswith("register") for total in back(name, 0)
    ]


@pytest.mark.parametrize("seed", range(40))
def test_no_path_is_longer_than_the_one_found(seed):
    rng = random.Random(seed)
    netlist = random_module(rng)
    inputs = [(name, pin) for name, c in netlist["cells"].items() for pin in c["connections"]]
    wire = {one: rng.randint(0, 9) for one in inputs}
    end = {one: rng.randint(0, 9) for one in inputs}
    start = rng.randint(0, 9)
    paths = every_path(netlist, (start, wire, end))
    found = find_longest(
        netlist,
        start=lambda _: start,
        through=lambda step: wire[step.cell, step.pin],
        end=lambda step: end[step.cell, step.pin],
    )
    assert found.total == max(paths)
    # The steps are a path that counts as much.
    *way, last = found.steps
    along = sum(wire[step.cell, step.pin] for step in way)
    assert start + along + end[last.cell, last.pin] == found.total
    cells = netlist["cells"]
    outputs = [cells[name]["connections"]["O"][0] for name in (found.start, *(s.cell for s in way))]
    assert [step.bit for step in found.steps] == outputs
    assert all(cells[step.cell]["connections"][step.pin] == [step.bit] for step in found.steps)


def count_steps(netlist):
    return find_longest(netlist, start=lambda _: 0, through=lambda _: 1, end=lambda _: 0)


def test_a_step_says_what_it_is():
    product = cell("MULT18X18", 0, A=1)
    product["connections"]["O"] = ["0", 2, 3]
    netlist = module(
        {
            "held": cell("FDRE", 1, C=9, D="0"),
            "product": product,
            "other": cell("FDRE", 4, C=9, D=3, CE=1),
            "pad": cell("OBUF", 5, I=3),
        }.items()
    )
    found = count_steps(netlist)
    assert (found.total, found.start) == (1, "held")
    assert found.steps == [
        Step(bit=1, fan_out=2, source="FDRE", cell="product", kind="MULT18X18", pin="A", out=2),
        Step(bit=3, fan_out=2, source="MULT18X18", cell="other", kind="FDRE", pin="D"),
    ]


def test_of_equal_paths_the_first_in_the_alphabet_is_taken():
    registers = [("b", cell("FDRE", 1, C=9, D=1, CE=1)), ("a", cell("FDRE", 2, C=9, D=1, CE=1))]
    for cells in (registers, registers[::-1]):
        (step,) = count_steps(module(cells)).steps
        assert (step.cell, step.pin) == ("a", "CE")


def test_pads_and_clocks_are_no_path():
    cells = {
        "from_pad": cell("IBUF", 1, I=7),
        "clock": cell("BUFG", 8, I=1),
        "held": cell("FDRE", 2, C=8, D=1),
        "to_pad": cell("OBUF", 7, I=2),
    }
    with pytest.raises(RuntimeError, match="no path from a register"):
        count_steps(module(cells.items()))


def test_each_port_of_a_memory_of_luts_is_read_by_its_own_address():
    memory = cell("RAM16X1D", 5, WCLK=9, A0=3, DPRA0=2, D="0", WE="0")
    memory["connections"] |= {"SPO": [6], "DPO": [5]}
    memory["port_directions"] |= {"SPO": "output", "DPO": "output"}
    del memory["connections"]["O"], memory["port_directions"]["O"]
    cells = {
        "held": cell("FDRE", 1, C=9, D="0"),
        "early": cell("LUT1", 2, I0=1),
        "late": cell("LUT1", 3, I0=2),
        "memory": memory,
        "read": cell("FDRE", 7, C=9, D=5),
    }
    # The address that is written by comes as late as the data that is read.
    found = count_steps(module(cells.items()))
    assert (found.total, found.steps[-1].cell) == (2, "memory")
    cells["read"] = cell("FDRE", 7, C=9, D=6)
    found = count_steps(module(cells.items()))
    assert (found.total, [s.pin for s in found.steps]) == (3, ["I0", "I0", "A0", "D"])


def test_what_is_no_path_is_told():
    circle = {"a": cell("LUT1", 1, I0=2), "b": cell("LUT1", 2, I0=1), "c": cell("FDRE", 3, D=1)}
    with pytest.raises(RuntimeError, match="combinational loop"):
        count_steps(module(circle.items()))
    with pytest.raises(RuntimeError, match="the cell SRL16 is not known"):
        count_steps(module({"a": cell("SRL16", 1, A0=2)}.items()))


def test_names_are_those_of_the_source():
    nets = {
        "held": {"hide_name": 0, "bits": [1, 2]},
        "top.held": {"hide_name": 0, "bits": [1], "offset": 3},
        "held$2": {"hide_name": 0, "bits": [1]},
        "part": {"hide_name": 0, "bits": [7, 8], "offset": 3},
        "$made": {"hide_name": 1, "bits": [9]},
    }
    names = {1: "top.held", 2: "held[1]", 7: "part[3]", 8: "part[4]"}
    assert signal_names({"netnames": nets}) == names
