"""Corrupted cloud files: each is a cloud, or one line of error. ``make fuzz SECONDS=60``."""

import argparse
import itertools
import random
import resource
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from contextlib import ExitStack, contextmanager
from pathlib import Path

from splatline.contract.errors import InputError
from splatline.host.cloud.bulk import far_points
from splatline.host.files.readers import read_cloud
from splatline.host.visibility.view import fit_view
from tests.host.files.corrupt import Sample, corrupt, whole_files

LONGEST = 1.0
"""Seconds of the processor: other programs do not count."""

MEMORY = 400 << 20
"""Bytes of address space that a small file may take."""


@contextmanager
def limited_memory():
    """Let the process grow by no more than ``MEMORY``."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + MEMORY, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def fault_of(path: Path) -> tuple[str, str]:
    """Read a file; return whether it is a cloud or refused, and what is wrong with that."""
    outcome, fault, taken = _read(path)
    if taken > LONGEST:  # Python may have collected all its garbage meanwhile
        taken = min(taken, _read(path)[2])
    return outcome, fault or (f"took {taken:.2f} s" if taken > LONGEST else "")


def _read(path: Path) -> tuple[str, str, float]:
    """Read a file; return the outcome, what is wrong with it, and the time that it took."""
    start = time.process_time()
    fault = ""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            cloud = read_cloud(path)
            fit_view(cloud)
            far_points(cloud.positions)
            outcome = "cloud"
        except InputError as error:
            outcome = "refused"
            text = str(error)
            if "\n" in text or len(text) > len(str(path)) + 400 or "memory" in text:
                fault = f"the message is {text[:600]!r}"
        except BaseException:
            outcome, fault = "failed", traceback.format_exc()
    return outcome, fault, time.process_time() - start


def load_readers(samples: list[Sample], folder: Path) -> None:
    """Read each sample once, so that neither time nor memory of imports and compiling counts."""
    for sample in samples:
        path = folder / sample.name
        path.write_bytes(sample.pack(sample.data))
        fault_of(path)


def run_seed(seed: int, samples: list[Sample], folder: Path) -> tuple[str, str, Path]:
    """Corrupt the sample of a seed, every second one in its header, and read it."""
    rng = random.Random(seed)
    sample = samples[seed // 2 % len(samples)]
    path = folder / sample.name
    path.write_bytes(corrupt(sample, rng, in_header=seed % 2 == 0))
    return *fault_of(path), path


def main() -> None:
    """Read corrupted files until the time is over; keep those that are not handled."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=None, help="the first")
    parser.add_argument("--keep", type=Path, default=Path("build/fuzz"))
    options = parser.parse_args()
    first = time.time_ns() // 1000 % 10**9 if options.seed is None else options.seed
    end = time.monotonic() + options.seconds
    outcomes: Counter[str] = Counter()
    faults = 0
    samples = whole_files()
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        load_readers(samples, Path(folder))
        stack.enter_context(limited_memory())
        for seed in itertools.count(first):
            if time.monotonic() > end:
                break
            outcome, fault, path = run_seed(seed, samples, Path(folder))
            outcomes[outcome] += 1
            if fault:
                faults += 1
                options.keep.mkdir(parents=True, exist_ok=True)
                kept = options.keep / f"{seed}_{path.name}"
                kept.write_bytes(path.read_bytes())
                print(f"{kept}: {fault}", flush=True)
    print(f"seeds from {first}: {dict(outcomes)}, {faults} not handled")
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
