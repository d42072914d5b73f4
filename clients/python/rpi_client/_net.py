"""Drawings of the nets of programs, by ``rpic graph``."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Net:
    """The net of a command as a drawing: ``mermaid`` in the language of Mermaid, ``dot`` in that of Graphviz.

    Jupyter shows it as SVG if Graphviz is installed. Otherwise JupyterLab 4.1 and later draw the text in the language of Mermaid."""

    mermaid: str
    dot: str

    @classmethod
    def of(cls, file: str | Path, *, command: str | None = None, rpic: str = "rpic") -> Net:
        """Draws the net of a program or net in a file; ``command`` if it has several, ``rpic`` is the compiler. ``ValueError`` with the
        diagnostics if the file does not compile, ``FileNotFoundError`` without the compiler."""
        return cls(*(_graph(rpic, file, command, language) for language in ("mermaid", "dot")))

    def svg(self) -> str | None:
        """Returns the drawing as SVG; None without Graphviz, or if Graphviz needs more than 20 s for it."""
        tool = shutil.which("dot")
        if tool is None:
            return None
        try:
            drawn = subprocess.run([tool, "-Tsvg"], input=self.dot, capture_output=True, text=True, encoding="utf-8", timeout=20, check=True)
        except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
            return None
        return drawn.stdout

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, str]:
        svg = self.svg()
        drawing = {"text/vnd.mermaid": self.mermaid} if svg is None else {"image/svg+xml": svg}
        return {"text/plain": self.mermaid, **drawing}


def _graph(rpic: str, file: str | Path, command: str | None, language: str) -> str:
    options = [] if command is None else ["--command", command]
    # An absolute path never begins with the sign of an option.
    arguments = [rpic, "graph", "--format", language, *options, str(Path(file).absolute())]
    output = subprocess.run(arguments, capture_output=True, text=True, encoding="utf-8", check=False)
    if output.returncode != 0:
        raise ValueError(output.stderr.strip() or f"rpic ended with the exit status {output.returncode}")
    return output.stdout
