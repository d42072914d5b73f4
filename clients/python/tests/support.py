"""Support of the tests: a server, and recordings of runs."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import tempfile
import time
import unittest
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

_Test = TypeVar("_Test", bound=Callable[..., Any])

#: Program of the server and of runs.
RPI = os.environ.get("RPI")
#: Attribute of tests and classes that need extras.
_NEEDS_EXTRAS = "needs_extras"

needs_rpi = unittest.skipUnless(RPI, "RPI does not name the server's program")


def needs(*packages: str) -> Callable[[_Test], _Test]:
    """Skips a test without these packages; with RPI_ALL_EXTRAS, where they must be there, the test fails instead."""
    missing = [package for package in packages if importlib.util.find_spec(package) is None]
    skipped = bool(missing) and "RPI_ALL_EXTRAS" not in os.environ

    def decorate(test: _Test) -> _Test:
        decorated = unittest.skipIf(skipped, f"without {', '.join(missing)}")(test)
        setattr(decorated, _NEEDS_EXTRAS, True)
        return decorated

    return decorate


CELL = """
[devices.arm]
kind = "arm"
model = "ur5e"
joints = "home"

[devices.hand]
kind = "gripper"
object = 0.03

[devices.barrier]
kind = "light-barrier"

[devices.belt]
kind = "conveyor"
"""


class CellTest(unittest.IsolatedAsyncioTestCase):
    """A test with a folder that has a cell with an arm, a gripper, a light barrier and a belt."""

    #: Port of the server on 127.0.0.1.
    port: int

    def setUp(self) -> None:
        method = getattr(self, self._testMethodName)
        if "RPI_ONLY_EXTRAS" in os.environ and not (hasattr(method, _NEEDS_EXTRAS) or hasattr(self, _NEEDS_EXTRAS)):
            # Packages do not change what it tests, and a server takes a second.
            self.skipTest("was run without extras")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "cell.toml").write_text(CELL, encoding="utf-8")
        self.socket = str(self.folder / "rpi.sock")

    def serve(self, *options: str) -> subprocess.Popen[bytes]:
        """Starts a server on the socket."""
        assert RPI is not None
        command = [RPI, "serve", "--cell", str(self.folder / "cell.toml"), "--listen", "127.0.0.1:0", "--socket", self.socket]
        messages = self.folder / "serve.log"
        with open(messages, "wb") as log:
            server = subprocess.Popen([*command, *options], stderr=log)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        for _ in range(500):
            lines = messages.read_text(encoding="utf-8").splitlines(keepends=True)
            if os.path.exists(self.socket) and lines and lines[0].endswith("\n"):
                self.port = int(lines[0].rpartition(":")[2])
                return server
            time.sleep(0.02)
        self.fail("the server does not listen")

    def run_program(self, text: str, *options: str) -> str:
        """Runs a program in the folder and returns its summary."""
        assert RPI is not None
        (self.folder / "program.rpi").write_text(text, encoding="utf-8")
        command = [RPI, "run", "program.rpi", *options]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout
