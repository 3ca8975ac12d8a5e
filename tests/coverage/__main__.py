"""What the tests reach, as a page: ``make coverage``.

python -m tests.coverage run      runs the tests with counters, for half an hour -> build/coverage
python -m tests.coverage report   writes docs/coverage.md from these
python -m tests.coverage          both
"""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

from tests.coverage.page import write_page

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "build" / "coverage"
PAGE = ROOT / "docs" / "coverage.md"

PASSES = {
    "the host and the models, whose compiled functions count": [
        *("-p", "tests.coverage.compiled", "tests", "--ignore", "tests/rtl"),
        *("--ignore", "tests/browser", "--ignore", "tests/boards", "--ignore", "tests/formal"),
        *("--ignore", "tests/docs", "--ignore", "tests/python_mutants"),
    ],
    "the hardware, whose Verilog counts": [
        *("-p", "tests.coverage.collect", "--cov-append"),
        *sorted(
            str(file)
            for folder in ("tests/rtl", "tests/rtl/bus")
            for file in (ROOT / folder).glob("test_*.py")
            if "faults" not in file.stem
        ),
    ],
}
"""Arguments of pytest. The modules of whole engines count, which the tests of parts do not build.
Planted faults change the Verilog, so they are left out."""


def main() -> int:
    """Run the tests, write the page, and return 1 if a goal is missed or a test fails."""
    parser = argparse.ArgumentParser(
        prog="make coverage",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("what", nargs="?", choices=["run", "report"])
    what = parser.parse_args().what
    status = 0
    if what != "report":
        shutil.rmtree(FOLDER, ignore_errors=True)
        for number, (name, arguments) in enumerate(PASSES.items()):
            print(f"Running the tests of {name} ...", flush=True)
            # Builds of one pass have no counters, and those with counters are of no use to others.
            status |= _run(arguments, ROOT / "build" / f"coverage-cache-{number}")
    if what != "run":
        missed = write_page(FOLDER, PAGE)
        print(f"{PAGE.relative_to(ROOT)} is written.")
        print(*missed[:20], sep="\n", end="\n" * bool(missed), file=sys.stderr)
        status |= bool(missed)
    return status


def _run(arguments: list[str], cache: Path) -> int:
    """Run pytest with the counters of coverage.py and a cache of builds; return its status."""
    environment = {
        **os.environ,
        "CI": "true",  # examples of hypothesis are the same every time
        "SPLATLINE_COUNTS": str(FOLDER / "counts"),
        "COVERAGE_FILE": str(FOLDER / "python"),
        "SPLATLINE_CACHE": str(cache),
    }
    FOLDER.mkdir(parents=True, exist_ok=True)
    call = [sys.executable, "-m", "pytest", "-q", "-n", "auto", "--dist", "loadfile"]
    call += ["--cov", "--cov-report", f"json:{FOLDER / 'python.json'}"]
    return subprocess.run([*call, *arguments], cwd=ROOT, env=environment, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
