"""Engines with a shape ROM: their pictures and their cycles, from the Verilog."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from splatline.cli.main import main
from splatline.contract.presets import PAPER
from splatline.contract.variants import SHAPED
from splatline.flow.verilog import generate
from splatline.host import fit_view, make_frame
from splatline.host.encode.shape_table import shape_table
from splatline.host.encode.sort_by_line import advance_word
from splatline.rtl.engine import engine_latency
from splatline.sim import golden
from splatline.sim.cosim import simulator
from splatline.sim.cosim.player.frames import Job, play
from splatline.sim.cosim.player.player import wrap
from splatline.sim.cosim.simulator import SimulationError
from splatline.sim.cycles.cycles import count_cycles
from tests.rtl.test_presets import RATES, back_to_back, behind_each_other, over_an_initial_raster
from tests.support.clouds import cloud_of
from tests.support.engines import engine, mismatches
from tests.support.faults import fault
from tests.support.random_frames import frame_of, nonsense, shapes
from tests.support.rom_words import compact_words, mixed_words

SMALL, FULL = SHAPED

WORD = int(shape_table()[8, 32, 32, 0]) << PAPER.scans.lsb
"""A disc of eight pixels as a plain word."""


def of_a_host(rng, config, size=(64, 48), largest=20):
    """What ``--shapes rom`` sends of discs of all sizes and slants, across every border."""
    cloud = cloud_of(rng.uniform(-1, 1, (500, 3)), rng.normal(size=(500, 3)))
    view = fit_view(cloud, size=size, zoom=1.4)
    pixels = rng.uniform(0, largest, 500) ** 2 / largest  # mostly small
    radii = 0.5 * pixels * np.linalg.norm(view.eye) / view.focal
    return make_frame(cloud, view, radii=radii, config=config, quality="paper", shapes="rom")


def mixed(rng, config, width=61, height=40):
    """Any words at all, half of them compact."""
    words = mixed_words(config, rng, 600)
    words[golden.decode(words, config)["end"]] &= ~np.uint64(1 << config.control_end.lsb)
    # Mostly within the image.
    x = words >> np.uint64(config.x.lsb) & np.uint64(config.x.mask)
    words &= ~np.uint64(config.x.mask << config.x.lsb)
    words |= x % np.uint64(width + 9) << np.uint64(config.x.lsb)
    steps = golden.decode(words, config)["control"]
    words[steps] = advance_word(2, config)
    return frame_of(words, width, height, int(rng.integers(1 << 30)), config)


def timed_jobs(rng, config):
    """Frames at full rate, whose cycles are counted."""
    yield Job(frame=of_a_host(rng, config))
    yield Job(frame=of_a_host(rng, config, (130, 20), 6))
    yield Job(frame=shapes(rng, 300, 64, 48, config=config))
    for _ in range(4):
        yield Job(frame=mixed(rng, config))
    # Words that give nothing, before the end and between others.
    nothing = compact_words(config, np.full(40, 17), 3, 3)
    dots = compact_words(config, np.full(40, 3), 3, 3, rest=20 << config.x.lsb)
    turns = np.stack([nothing, dots]).T.ravel()
    for words in (nothing, turns, dots, np.append(advance_word(9, config), turns)):
        yield Job(frame=frame_of(words, 64, 20, config=config))


@pytest.mark.parametrize("config", SHAPED, ids=lambda config: config.name)
def test_pictures_are_golden_s_and_cycles_are_the_model_s(config):
    rng = np.random.default_rng(31)
    jobs = list(timed_jobs(rng, config))
    timed = len(jobs)
    for seed, rates in enumerate(RATES):
        jobs.append(Job(frame=of_a_host(rng, config), rates=rates, seed=seed))
        jobs.append(Job(frame=mixed(rng, config), rates=rates, seed=seed))
        jobs.append(Job(frame=nonsense(rng, 400, 101, 40, config=config), rates=rates, seed=seed))
    jobs += [*back_to_back(rng, config), *list(over_an_initial_raster(rng, config))[:4]]
    jobs += behind_each_other(rng, config)
    frame = mixed(rng, config)
    jobs += [Job(frame=frame, reset_after=after, seed=after) for after in (140, 300, 451)]
    outcomes = play(jobs, built=engine(config))
    assert not any(map(mismatches, jobs, outcomes))
    counted = [count_cycles(jobs[n].frame, after_reset=n == 0) for n in range(timed)]
    assert counted == [outcomes[n].cycles for n in range(timed)]


def test_the_rom_costs_a_frame_its_latency_at_the_most():
    """By the model of the clock: words that wait in the ROM bridge the cycles of control words."""
    cloud = cloud_of(*np.random.default_rng(5).normal(size=(2, 3000, 3)))
    view = fit_view(cloud, size=(96, 64))
    options = {"radii": np.full(3000, 0.05), "quality": "paper"}
    rom = make_frame(cloud, view, config=SMALL, shapes="rom", **options)
    table = make_frame(cloud, view, config=PAPER, **options)
    assert len(rom.codewords) == len(table.codewords)
    least, most = (count_cycles(frame, after_reset=False) for frame in (table, rom))
    assert most - least <= engine_latency(SMALL) - engine_latency(PAPER) == 3
    # With one element and no control word to bridge it is all of it.
    one = [compact_words(SMALL, 8, 32, 32), np.uint64(WORD)]
    cycles = [
        count_cycles(frame_of([word], 64, 48, config=config), after_reset=False)
        for word, config in zip(one, (SMALL, PAPER), strict=True)
    ]
    assert cycles[0] - cycles[1] == 3


@pytest.mark.parametrize("config", SHAPED, ids=lambda config: config.name)
def test_the_command_line_draws_a_scene_with_the_rom_s_verilog(config, tmp_path):
    """From the scene to its picture, with nothing put in the simulation's place."""
    stats = tmp_path / "knot.json"
    options = ["--scene", "knot", "--size", "48x32", "--shapes", "rom", "--engine", "rtl"]
    options += ["--preset", config.name, "-o", tmp_path / "knot.png", "--stats", stats]
    result = CliRunner().invoke(main, ["render", *map(str, options)], prog_name="splatline")
    assert result.exit_code == 0, result.stderr
    numbers = json.loads(stats.read_text())
    assert (numbers["preset"], numbers["mismatched_pixels"]) == (config.name, 0)
    assert numbers["bits_sent"].keys() == {"rom", "table"}
    assert numbers["bits_sent"]["rom"] == 64 * numbers["codewords"]
    assert numbers["bits_sent"]["rom"] <= numbers["bits_sent"]["table"]
    assert f"{numbers['bits_sent']['rom']:,} (rom)" in result.stdout


@pytest.mark.planted
def test_a_rom_that_mirrors_nothing_is_noticed():
    broken = fault("splatline.shapes", "mirror", "1'h0")
    frame = of_a_host(np.random.default_rng(6), SMALL, (32, 24), 9)
    quickest = "icarus" if simulator.available("icarus") else "verilator"  # to build
    try:
        built = wrap(broken(generate(SMALL)[0]), SMALL, simulator_name=quickest)
        outcome = play([Job(frame=frame)], built=built)[0]
    except SimulationError:
        return
    assert outcome.raster.mismatches(golden.render(frame)) > 0
