"""Drawings of nets by a stand-in of ``rpic``, and by ``rpic`` itself where RPIC names it."""

from __future__ import annotations

import os
import stat
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from rpi_client import Net

PROGRAM = "command Count () let n = 1 -> pre n + 1; export n; finish done when n >= 3; tel\n"

#: Prints its arguments as `rpic graph` would print a drawing, and fails for a file with the name wrong.rpi.
STAND_IN = """#!/bin/sh
case "$*" in
  *wrong.rpi) echo "error RPI0001: wrong" >&2; exit 1;;
  *) echo "$*";;
esac
"""


class NetTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def executable(self, name: str, text: str) -> str:
        """Writes a program and returns its path."""
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return str(path)

    def test_options_and_errors_of_the_compiler(self) -> None:
        rpic = self.executable("rpic", STAND_IN)
        net = Net.of("-odd.rpi", command="Count", rpic=rpic)
        self.assertEqual(net.mermaid, f"graph --format mermaid --command Count {Path('-odd.rpi').absolute()}\n")
        self.assertEqual(net.dot.split()[:3], ["graph", "--format", "dot"])
        with self.assertRaisesRegex(ValueError, "RPI0001: wrong"):
            Net.of("wrong.rpi", rpic=rpic)
        with self.assertRaises(FileNotFoundError):
            Net.of("odd.rpi", rpic=str(self.folder / "none"))

    def test_jupyter_gets_svg_with_graphviz_and_mermaid_without(self) -> None:
        net = Net("graph TD", "digraph {}")
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            self.assertEqual(net._repr_mimebundle_(), {"text/plain": "graph TD", "text/vnd.mermaid": "graph TD"})
            self.executable("dot", "#!/bin/sh\nread text\necho \"<svg>$text</svg>\"\n")
            self.assertEqual(net._repr_mimebundle_()["image/svg+xml"].strip(), "<svg>digraph {}</svg>")
            self.executable("dot", "#!/bin/sh\nexit 1\n")
            self.assertNotIn("image/svg+xml", net._repr_mimebundle_())

    @unittest.skipUnless("RPIC" in os.environ, "RPIC does not name the compiler")
    def test_the_compiler_draws(self) -> None:
        (self.folder / "count.rpi").write_text(PROGRAM, encoding="utf-8")
        net = Net.of(self.folder / "count.rpi", rpic=os.environ["RPIC"])
        self.assertTrue(net.mermaid.startswith(("flowchart", "graph")), net.mermaid)
        self.assertTrue(net.dot.startswith("digraph"), net.dot)


if __name__ == "__main__":
    unittest.main()
