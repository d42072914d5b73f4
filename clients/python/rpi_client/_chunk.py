"""Chunks of a policy, and the observations on which they are based."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Union

from ._flow_types import SupportsToList
from ._values import Pose

#: Rows of joint positions: a list of lists, or an array of numpy with two axes.
Rows = Union[Sequence[Sequence[float]], Sequence[SupportsToList], SupportsToList]

#: Least and largest number of rows of a chunk.
LEAST_ROWS, MOST_ROWS = 4, 200


@dataclass(frozen=True)
class Observation:
    """State of the arm in one cycle, as the server reported it.

    ``positions`` (rad) and ``velocities`` (rad/s) are those measured at the joints, ``commanded`` the set-points (rad), ``pose`` the
    measured pose of the tool in the base of the arm; ``values`` has the other exported flows by name (each a :data:`Value`). ``server_time`` is the time of the cycle by the
    clock of the command, in seconds since its start, ``time`` the same by ``time.monotonic()``. ``accepted`` is the number of the
    chunk that the arm follows, 0 before the first one; ``remaining`` the time until its last row (s), ``lag`` the time by which the arm is behind it
    (s), and ``late`` whether the arm brakes or rests because no chunk has come. ``number`` counts the observations from 1."""

    number: int
    server_time: float
    time: float
    positions: list[float] = field(default_factory=list)
    velocities: list[float] = field(default_factory=list)
    commanded: list[float] = field(default_factory=list)
    pose: Pose = field(default_factory=Pose)
    accepted: int = 0
    remaining: float = 0.0
    lag: float = 0.0
    late: bool = True
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Chunk:
    """Joint positions that a policy wants: a row for every period of the stream, with a position (rad) for every joint; 4 rows or more.

    ``observed`` is the time of the first row, that of the observation on which the chunk is based: an :class:`Observation`, or the
    time stamp of a camera as a time of ``time.monotonic()``. None is the observation that the policy got last, and without a policy the time of sending.
    ``velocities`` (rad/s) has the same form as ``positions``. ``widths`` has the opening of the gripper at each row (m).
    ``append`` lets the first row follow one period after the last one of the chunk before, instead of overlapping it.
    ``frozen`` is the number of first rows that are taken from the chunk before, because the arm executes them while the policy computes."""

    positions: Rows
    observed: Observation | float | None = None
    velocities: Rows | None = None
    widths: Sequence[float] | SupportsToList | None = None
    append: bool = False
    frozen: int = 0


@dataclass(frozen=True)
class SentChunk:
    """A chunk on its way: when it was sent and from when its first row is (``time.monotonic()``, and the server's clock), its rows."""

    number: int
    sent: float
    start: float
    rows: list[list[float]]


def rows_of(name: str, rows: Any, width: int, most: int) -> list[list[float]]:
    """Returns rows as lists. ``TypeError`` unless they are rows of numbers, ``ValueError`` if a row has another length than ``width``, and for less than 4
    or more than ``most`` rows."""
    listed = rows.tolist() if hasattr(rows, "tolist") else rows
    if isinstance(listed, (str, bytes)) or not isinstance(listed, Sequence):
        raise TypeError(f"{name}: {rows!r} is not a sequence of rows")
    plain = [row.tolist() if hasattr(row, "tolist") else row for row in listed]
    if not LEAST_ROWS <= len(plain) <= most:
        raise ValueError(f"{name}: {LEAST_ROWS} to {most} rows are needed, and there are {len(plain)}")
    for row in plain:
        if isinstance(row, (str, bytes)) or not isinstance(row, Sequence):
            raise TypeError(f"{name}: {row!r} is not a row of numbers")
        if len(row) != width:
            raise ValueError(f"{name}: a row of {width} numbers is needed, and {row!r} has {len(row)}")
    return [[_number(name, value) for value in row] for row in plain]


def _number(name: str, value: Any) -> float:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"{name}: {value!r} is not a number")
    return float(value)


def padded(rows: list[list[float]], count: int) -> list[float]:
    """Returns the numbers of ``count`` rows, row by row; the last row is repeated, and the arm does not read the repetitions."""
    missing = count - len(rows)
    return [value for row in [*rows, *[rows[-1]] * missing] for value in row]
