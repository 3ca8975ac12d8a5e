"""Corrupted files of each format, corrupted frames, and views of any numbers."""

import random
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from splatline.contract.errors import InputError
from splatline.contract.presets import PAPER
from splatline.host.files.readers import format_suffix
from splatline.host.frame_file import load_frame, save_frame, sidecar_path
from splatline.host.pipeline import make_frames
from splatline.host.visibility.block_index import build_index
from splatline.sim import golden
from tests.host.files.corrupt import Sample, corrupt, whole_files
from tests.host.files.fuzz import fault_of, limited_memory, load_readers
from tests.host.visibility.test_any_view import fitted, plain, small_cloud

__all__ = ["corrupted_files", "corrupted_frames", "views"]

Found = Iterator[tuple[str, str]]
"""Of each trial what came of it, and what is wrong with that, or nothing."""


def corrupted_files(suffix: str, numbers: range, folder: Path) -> Found:
    """Read corrupted files of a format."""
    samples = [each for each in whole_files() if format_suffix(Path(each.name)) == suffix]
    assert samples, suffix
    load_readers(samples, folder)
    with limited_memory():
        for number in numbers:
            rng = random.Random(f"{suffix} {number}")
            sample = samples[number // 2 % len(samples)]
            path = folder / sample.name
            path.write_bytes(corrupt(sample, rng, in_header=number % 2 == 0))
            outcome, fault = fault_of(path)
            yield {"cloud": "done"}.get(outcome, outcome), fault and f"{suffix} {number}: {fault}"


def corrupted_frames(numbers: range, folder: Path) -> Found:
    """Load corrupted frames, or whole ones with a corrupted description, and draw them."""
    cloud = small_cloud()
    (frame,) = make_frames(
        build_index(cloud, radii=np.full(40, 0.2)), fitted_view(cloud), config=PAPER
    )
    path = folder / "a.frame"
    save_frame(frame, path)
    whole = [
        Sample(each.name, each.read_bytes(), len(each.read_bytes()))
        for each in (path, sidecar_path(path))
    ]
    for number in numbers:
        rng = random.Random(f"frame {number}")
        for n, sample in enumerate(whole):
            data = corrupt(sample, rng, in_header=False) if n == number % 2 else sample.data
            (folder / sample.name).write_bytes(data)
        outcome, fault = _drawn(path)
        yield outcome, fault and f"frame {number}: {fault}"


def _drawn(path: Path) -> tuple[str, str]:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            golden.render(load_frame(path))
        except InputError as error:
            return "refused", str(error) if "\n" in str(error) else ""
        except Exception as error:
            return "failed", repr(error)
    return "done", ""


def fitted_view(cloud):
    """Return a usual view of a cloud."""
    from splatline.host.visibility.view import fit_view

    return fit_view(cloud, size=(64, 48))


def views(numbers: range, _: Path) -> Found:
    """Draw a small cloud from views of any numbers."""
    cloud = small_cloud()
    index = build_index(cloud, radii=np.full(40, 0.2))
    for number in numbers:
        rng = np.random.default_rng(number)
        make = (fitted, plain)[number % 2]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                (frame,) = make_frames(index, make(rng, cloud), config=PAPER)
                golden.render(frame)
            except InputError as error:
                yield "refused", str(error) if "\n" in str(error) else ""
            except Exception as error:
                yield "failed", f"view {number}: {error!r}"
            else:
                yield "done", ""
