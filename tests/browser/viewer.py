"""`splatline view` in a process of its own, on a port and with a token that a test knows."""

import os
import re
import signal
import subprocess
import sys

TOKEN = "token-of-the-tests"

# The token is random, and so is another one after a restart: a test that restarts fixes it.
PROGRAM = f"""
import secrets, sys
secrets.token_urlsafe = lambda *size: {TOKEN!r}
from splatline.cli.main import main
sys.argv = ["splatline", *sys.argv[1:]]
main()
"""


class Viewer:
    """A running `splatline view`."""

    def __init__(self, *arguments, port=0):
        command = [sys.executable, "-c", PROGRAM, "view", "--no-browser", "--port", str(port)]
        self.process = subprocess.Popen(
            [*command, *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1"},
        )
        self.address = self.process.stdout.readline().strip()
        assert self.address.startswith("http://127.0.0.1:"), self.address
        self.port = int(re.search(r":(\d+)/", self.address).group(1))

    def kill(self):
        """Kill it, so that it cannot say goodbye."""
        self.process.kill()
        self._wait()

    def interrupt(self):
        """Press Ctrl-C; return the exit code."""
        self.process.send_signal(signal.SIGINT)
        return self._wait()

    def _wait(self):
        try:
            return self.process.wait(20)
        finally:
            self.process.kill()
            self.process.stdout.close()
            self.process.wait()
