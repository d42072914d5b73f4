"""Parts of programs as texts."""

from __future__ import annotations

import math
import re
from decimal import Decimal


def identifier(name: str) -> str:
    """Returns a name that may stand in a program; ``ValueError`` otherwise."""
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name, re.ASCII):
        raise ValueError(f"{name!r} is not a name in programs")
    return name


def real_text(name: str, value: float) -> str:
    """Returns the literal of a positive number; ``ValueError`` for any other one."""
    if not (math.isfinite(value) and value > 0):
        raise ValueError(f"{name} is {value}, not a positive number")
    text = format(Decimal(repr(float(value))), "f")
    return text if "." in text else f"{text}.0"
