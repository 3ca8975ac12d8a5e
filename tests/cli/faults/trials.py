"""What goes wrong about a command, and what must come of it."""

import io
import json
import random
import shutil
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from PIL import Image

from .commands import COMMANDS, Command, write_inputs
from .forker import Forker, Outcome, Trial

__all__ = ["KINDS", "Bench"]

OLD = b"what was there before"

KILLED = (-9, -25)
"""SIGKILL, and SIGXFSZ in the middle of a write."""


class Bench:
    """A folder with inputs in which commands run, and what they write when nothing goes wrong.

    Parameters
    ----------
    forker
        Runs the commands.
    folder
        An empty folder.
    commands
        Names of the commands; all by default.
    """

    def __init__(
        self, forker: Forker, folder: Path, commands: tuple[str, ...] | None = None
    ) -> None:
        self.forker, self.folder = forker, folder
        self._inputs = folder / "inputs"
        self._inputs.mkdir()
        write_inputs(self._inputs)
        self.commands = [each for each in COMMANDS if commands is None or each.name in commands]
        if any(command.name == "play" for command in self.commands):
            words = ("encode", "a.csv", "--size", "48x32", "-o", "in.frame")
            outcome = forker.run(Trial(words, str(self._inputs)))
            assert outcome.code == 0, outcome.told
        self.whole: dict[str, dict[str, bytes]] = {}
        self.operations: dict[str, int] = {}
        self.seconds: dict[str, float] = {}
        for command in self.commands:
            place = self.fresh(command, old=False)
            begin = time.monotonic()
            outcome = forker.run(Trial(command.arguments, str(place)))
            assert outcome.code == 0, outcome.told
            self.seconds[command.name] = time.monotonic() - begin
            self.operations[command.name] = outcome.operations
            self.whole[command.name] = {
                name: (place / name).read_bytes() for name in self._written(place)
            }
            assert set(command.files) <= set(self.whole[command.name])

    def fresh(self, command: Command, *, old: bool) -> Path:
        """Return the folder of a trial: with the inputs, and old files under the final names."""
        place = self.folder / "here"
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(self._inputs, place)
        for name in command.files if old else ():
            if "/" not in name:
                (place / name).write_bytes(OLD)
        return place

    def _written(self, place: Path) -> Iterator[str]:
        """Yield the names of the files in a folder that are no inputs."""
        for path in sorted(place.rglob("*")):
            name = path.relative_to(place).as_posix()
            if path.is_file() and not (self._inputs / name).exists():
                yield name

    def play(
        self, make: Callable[["Bench", Command, random.Random], Trial], seed: int
    ) -> tuple[str, str]:
        """Play a trial; return what came of it, and what is wrong with that, or nothing."""
        rng = random.Random(f"{make.__name__} {seed}")
        command = rng.choice(self.commands)
        place = self.fresh(command, old=rng.random() < 0.5)
        trial = make(self, command, rng)
        place.chmod(0o555 if trial.read_only else 0o755)
        outcome = self.forker.run(trial)
        place.chmod(0o755)
        wrong = self._wrong(command, place, outcome)
        if not wrong and outcome.code in KILLED:
            again = self.forker.run(Trial(command.arguments, str(place)))
            if again.code:
                wrong = f"the run after it ends with {again.code}: {again.told}"
            else:
                wrong = self._wrong(command, place, replace(again, code=-9))
        came = {0: "done", 2: "refused"} | dict.fromkeys(KILLED, "killed")
        told = f"{make.__name__} {seed}, {command.name}: {wrong}" if wrong else ""
        return came.get(outcome.code, "failed"), told

    def _wrong(self, command: Command, place: Path, outcome: Outcome) -> str:
        """Return what is wrong with an outcome and the files that are there."""
        ours = [line for line in outcome.told.splitlines() if line.startswith("splatline: ")]
        if outcome.code not in (0, 2, *KILLED) or "Traceback" in outcome.told:
            return f"ends with {outcome.code}: {outcome.told[-2000:]}"
        if outcome.code == 2 and (len(ours) != 1 or not outcome.told.endswith(ours[0] + "\n")):
            return f"is not told in a line: {outcome.told[-500:]}"
        whole = self.whole[command.name]
        for name in self._written(place):
            data = (place / name).read_bytes()
            if name not in whole:
                if outcome.code not in KILLED or not Path(name).name.startswith("."):
                    return f"leaves {name}"
            elif not _same(name, data, whole[name]) and (data != OLD or outcome.code == 0):
                return f"{name} is not whole"
        return ""

    def trial(self, command: Command, **faults: object) -> Trial:
        """Return a trial of a command in the folder of trials."""
        return Trial(command.arguments, str(self.folder / "here"), **faults)


def _same(name: str, data: bytes, whole: bytes) -> bool:
    """Return whether a file is whole. JSON and figures have times in them, so they are read."""
    if name.endswith((".json", "figure.png")):
        try:
            if name.endswith(".png"):
                Image.open(io.BytesIO(data)).load()
                return True
            return json.loads(data).keys() == json.loads(whole).keys()
        except (ValueError, OSError):
            return False
    return data == whole


def _longest(bench: Bench, command: Command) -> int:
    return max(map(len, bench.whole[command.name].values()))


def full_disk(bench: Bench, command: Command, rng: random.Random) -> Trial:
    """Writing fails at a random byte of a file."""
    return bench.trial(command, most_bytes=rng.randrange(_longest(bench, command)))


def killed_in_a_write(bench: Bench, command: Command, rng: random.Random) -> Trial:
    """The process dies in the middle of a write, at a random byte of a file."""
    most = rng.randrange(_longest(bench, command))
    return bench.trial(command, most_bytes=most, dies=True)


def killed_between(bench: Bench, command: Command, rng: random.Random) -> Trial:
    """The process dies before an operation on a file: to make, rename, remove it."""
    return bench.trial(command, kill_at=rng.randrange(bench.operations[command.name]))


def killed_at_any_time(bench: Bench, command: Command, rng: random.Random) -> Trial:
    """The process dies at a random time: within what it takes when nothing goes wrong."""
    return bench.trial(command, kill_after=rng.uniform(0.0, bench.seconds[command.name]))


def read_only_folder(bench: Bench, command: Command, rng: random.Random) -> Trial:
    """The user may not write to the folder."""
    return bench.trial(command, read_only=True)


def little_memory(bench: Bench, command: Command, rng: random.Random) -> Trial:
    """The process may grow by up to 200 MB."""
    return bench.trial(command, memory=rng.randrange(200 << 20))


KINDS = {
    "full disk": full_disk,
    "killed in a write": killed_in_a_write,
    "killed between operations": killed_between,
    "killed at any time": killed_at_any_time,
    "read-only folder": read_only_folder,
    "little memory": little_memory,
}
