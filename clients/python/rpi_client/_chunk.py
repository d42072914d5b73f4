"""Chunks of a policy, and the observations on which they are based."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Union

from ._flow_types import SupportsToList
from ._values import Pose, Rotation, Vector

#: Rows of joint positions or poses: a list of lists, an array of numpy with two axes, or a list of poses.
Rows = Union[Sequence[Sequence[float]], Sequence[SupportsToList], SupportsToList, Sequence[Pose]]

#: Least and largest number of rows of a chunk.
LEAST_ROWS, MOST_ROWS = 4, 200

#: Greatest number of rows that the arm keeps to be executed.
MOST_WAITING = 400

#: Numbers of a row of poses: position (m) and orientation (unit quaternion x, y, z, w).
POSE_NUMBERS = 7

#: Kinds of limits by their numbers in the motion of the library.
_LIMITS = ("none", "velocity", "acceleration", "jerk", "range")

#: Types of numbers that need no conversion.
_PLAIN = {float, int}


class Limit(NamedTuple):
    """A limit that binds: the joint, counted from 0, and the ``kind``: ``velocity``, ``acceleration``, ``jerk`` or ``range``."""

    joint: int
    kind: str

    def __str__(self) -> str:
        return f"{self.kind} of joint {self.joint}"


def limit_of(axis: int, kind: int) -> Limit | None:
    """Returns the limit with the numbers that the motion of the library reports; None for 0, no limit."""
    return Limit(axis - 1, _LIMITS[kind]) if 0 < kind < len(_LIMITS) else None


@dataclass(frozen=True)
class Observation:
    """State of the arm in one cycle, as the server reported it.

    ``positions`` (rad) and ``velocities`` (rad/s) are those measured at the joints, ``commanded`` the set-points (rad), ``pose`` the
    measured pose of the tool in the base of the arm; ``values`` has the other exported flows by name (each a :data:`Value`). ``server_time`` is the time of the cycle by the
    clock of the command, in seconds since its start, ``time`` the same by ``time.monotonic()``. ``accepted`` is the number of the
    chunk that the arm follows, 0 before the first one; ``remaining`` the time until its last row (s), ``lag`` the time by which the arm is behind it
    (s), ``deviation`` the largest distance of a joint from the smoothed chunk (rad), ``limit`` a limit that binds, and ``late`` whether the arm
    brakes or rests because no chunk has come. ``number`` counts the observations from 1."""

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
    deviation: float = 0.0
    limit: Limit | None = None
    late: bool = True
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Chunk:
    """Joint positions that a policy wants: a row for every period of the stream, with a position (rad) for every joint; 4 rows or more. With
    ``poses`` of the options a row is a :class:`Pose` of the tool in the base of the arm, or its 7 numbers: position (m), quaternion x, y, z, w.

    ``observed`` is the time of the first row, that of the observation on which the chunk is based: an :class:`Observation`, or the
    time stamp of a camera as a time of ``time.monotonic()``. None is the observation that the policy got last, and without a policy the time of sending.
    ``velocities`` (rad/s) has the same form as ``positions``. ``widths`` has the opening of the gripper at each row (m),
    ``channels`` the values at each row of the actuators that ``channels`` of the options names; for truth values, bools or numbers from 0.5 on.
    ``append`` lets the first row follow one period after the last one of the chunk before, instead of overlapping it.
    ``frozen`` is the number of first rows that are taken from the chunk before, because the arm executes them while the policy computes."""

    positions: Rows
    observed: Observation | float | None = None
    velocities: Rows | None = None
    widths: Sequence[float] | SupportsToList | None = None
    append: bool = False
    frozen: int = 0
    channels: Mapping[str, Sequence[float] | Sequence[bool] | SupportsToList] = field(default_factory=dict)


@dataclass(frozen=True)
class SentChunk:
    """A chunk on its way: when it was sent and from when its first row is (``time.monotonic()``), its rows, and the values of other devices at each
    row by the name of their input."""

    number: int
    sent: float
    start: float
    rows: list[list[float]]
    channels: dict[str, list[float]] = field(default_factory=dict)


def rows_of(name: str, rows: Any, width: int, most: int) -> list[list[float]]:
    """Returns rows as lists of numbers; a pose has 7 of them. ``TypeError`` unless they are rows of numbers, ``ValueError`` if a row has another length than ``width``, and for less than 4
    or more than ``most`` rows."""
    listed = rows.tolist() if hasattr(rows, "tolist") else rows
    if isinstance(listed, (str, bytes)) or not isinstance(listed, Sequence):
        raise TypeError(f"{name}: {rows!r} is not a sequence of rows")
    plain = [row.tolist() if hasattr(row, "tolist") else row for row in listed]
    if not LEAST_ROWS <= len(plain) <= most:
        raise ValueError(f"{name}: {LEAST_ROWS} to {most} rows are needed, and there are {len(plain)}")
    return [_row(name, row, width) for row in plain]


def _row(name: str, row: Any, width: int) -> list[float]:
    if isinstance(row, Pose):
        row = [*row.position, *row.orientation]
    if isinstance(row, (str, bytes)) or not isinstance(row, Sequence):
        raise TypeError(f"{name}: {row!r} is not a row of numbers")
    if len(row) != width:
        raise ValueError(f"{name}: a row of {width} numbers is needed, and {row!r} has {len(row)}")
    # A chunk has hundreds of numbers, and most have one of these two types.
    return list(map(float, row)) if _PLAIN.issuperset(map(type, row)) else [_number(name, value) for value in row]


def _number(name: str, value: Any) -> float:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise TypeError(f"{name}: {value!r} is not a number")
    return float(value)


def channel_of(name: str, values: Any, count: int) -> list[float]:
    """Returns the values of a channel as one number for each of ``count`` rows: 1 for true, 0 for false. Errors as of :func:`rows_of`."""
    listed = values.tolist() if hasattr(values, "tolist") else values
    return column_of(name, [float(value) if isinstance(value, bool) else value for value in listed], count)


def column_of(name: str, values: Any, count: int) -> list[float]:
    """Returns one number for each of ``count`` rows. Errors as of :func:`rows_of`."""
    listed = values.tolist() if hasattr(values, "tolist") else values
    column = [row[0] for row in rows_of(name, [[value] for value in listed], 1, MOST_ROWS)]
    if len(column) != count:
        raise ValueError(f"{name}: {count} are needed, and there are {len(column)}")
    return column


def poses_of(rows: list[list[float]]) -> list[Pose]:
    """Returns rows of 7 numbers as poses."""
    return [Pose(Vector(*row[:3]), Rotation(*row[3:])) for row in rows]


def padded(rows: list[list[float]], count: int) -> list[float]:
    """Returns the numbers of ``count`` rows, row by row; the last row is repeated, and the arm does not read the repetitions."""
    return [value for row in lengthened(rows, count) for value in row]


def lengthened(items: list[Any], count: int) -> list[Any]:
    """Returns the items with repetitions of the last one, ``count`` in all."""
    return [*items, *[items[-1]] * (count - len(items))]
