"""A command loads numba without scipy's linear algebra, in fresh processes."""

import subprocess
import sys

SCRIPT = """
import sys
from splatline.cli.report.numba_import import import_numba
if "early" in sys.argv:
    import scipy.linalg
import_numba()
import_numba()
print("scipy.linalg" in sys.modules)
import scipy.linalg
print(scipy.linalg.det([[2.0]]))
"""

COMMAND = """
import sys
from splatline.cli.main import main
try:
    main(["render", "--scene", "knot", "--size", "32x24", "-o", "knot.png"])
finally:
    print([name for name in sys.modules if name in ("scipy.linalg", "scipy.spatial")])
"""


def said(folder, *arguments):
    ran = subprocess.run(
        [sys.executable, "-c", *arguments], cwd=folder, capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    return ran.stdout.splitlines()


def test_scipy_s_linear_algebra_is_hidden_until_numba_is_loaded(tmp_path):
    assert said(tmp_path, SCRIPT) == ["False", "2.0"]
    assert said(tmp_path, SCRIPT, "early") == ["True", "2.0"]


def test_a_picture_needs_none_of_it(tmp_path):
    assert said(tmp_path, COMMAND)[-1] == "[]"
    assert (tmp_path / "knot.png").exists()
