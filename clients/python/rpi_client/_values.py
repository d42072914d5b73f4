"""Values of the spatial types, in SI units: metres, radians, seconds, newtons."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple


class Vector(NamedTuple):
    """A vector with the components ``x``, ``y``, ``z``; in metres for a position."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


class Rotation(NamedTuple):
    """A rotation as a unit quaternion, in the order ``x``, ``y``, ``z``, ``w`` of ROS and scipy; the default turns nothing."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0

    @classmethod
    def from_euler(cls, a: float, b: float, c: float) -> Rotation:
        """Returns the rotation with these Euler angles in radians: ``a`` about z, then ``b`` about y, then ``c`` about x of the turned
        frame, as ``pose(.., a, b, c)`` in programs."""
        (sa, ca), (sb, cb), (sc, cc) = ((math.sin(t / 2), math.cos(t / 2)) for t in (a, b, c))
        return cls(
            ca * cb * sc - sa * sb * cc,
            ca * sb * cc + sa * cb * sc,
            sa * cb * cc - ca * sb * sc,
            ca * cb * cc + sa * sb * sc,
        )

    def euler(self) -> tuple[float, float, float]:
        """Returns the Euler angles in radians of :meth:`from_euler`; ``b`` is within a quarter turn, and ``a`` is 0 if ``b`` is exactly
        a quarter turn, where only the sum or the difference of ``a`` and ``c`` counts."""
        (r11, r12, r13), (r21, r22, r23), (r31, _, _) = self.matrix()
        a = math.atan2(r21, r11)
        # The third angle follows from the first (Shoemake, Graphics Gems IV, "Euler angle conversion"), so that both fit
        # together close to b = 90 degrees, where each alone is mostly rounding.
        sine, cosine = math.sin(a), math.cos(a)
        c = math.atan2(sine * r13 - cosine * r23, cosine * r22 - sine * r12)
        return a, math.atan2(-r31, math.hypot(r11, r21)), c

    def matrix(self) -> list[list[float]]:
        """Returns the rotation matrix, 3 rows of 3; ``ValueError`` unless the quaternion has length 1 within 1e-6."""
        x, y, z, w = self
        if not abs(x * x + y * y + z * z + w * w - 1.0) < 2e-6:
            raise ValueError(f"{self} is not a unit quaternion")
        return [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]


@dataclass(frozen=True)
class Pose:
    """A pose: a ``position`` in metres and an ``orientation``."""

    position: Vector = Vector()
    orientation: Rotation = Rotation()

    @classmethod
    def from_euler(cls, x: float, y: float, z: float, a: float, b: float, c: float) -> Pose:
        """Returns the pose at a position (m) with Euler angles (rad), as ``pose(x, y, z, a, b, c)`` in programs."""
        return cls(Vector(x, y, z), Rotation.from_euler(a, b, c))

    def matrix(self) -> list[list[float]]:
        """Returns the homogeneous matrix, 4 rows of 4, which maps coordinates in the frame of the pose to its base."""
        rows = zip(self.orientation.matrix(), self.position, strict=True)
        return [[*row, shift] for row, shift in rows] + [[0.0, 0.0, 0.0, 1.0]]


@dataclass(frozen=True)
class Twist:
    """A velocity of a body: ``linear`` in m/s, ``angular`` in rad/s."""

    linear: Vector = Vector()
    angular: Vector = Vector()


@dataclass(frozen=True)
class Wrench:
    """A ``force`` in N and a ``torque`` in N m."""

    force: Vector = Vector()
    torque: Vector = Vector()
