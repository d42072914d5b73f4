"""Devices of the cell: commands for usual motions, and their sensors."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from decimal import Decimal
from typing import TYPE_CHECKING

from ._values import Pose

if TYPE_CHECKING:
    from ._core import DeviceInfo
    from ._goal import Goal, Session

#: Modules and types of the library by the kind of the device.
_TYPES = {
    "gripper": ("devices", "Gripper"),
    "force-torque": ("devices", "ForceSensor"),
    "light-barrier": ("devices", "LightBarrier"),
    "conveyor": ("devices", "Conveyor"),
    "spindle": ("devices", "Spindle"),
    "linear-unit": ("devices", "LinearUnit"),
    "positioner": ("devices", "Positioner"),
    "base": ("devices", "MobileBase"),
}


class Device:
    """A device of the server's cell, as commands of this session use it. ``name`` and ``kind`` are those of :class:`DeviceInfo`."""

    def __init__(self, session: Session, info: DeviceInfo) -> None:
        self._session = session
        self.name = info.name
        self.kind = info.kind
        self._joint_count = info.joint_count

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.name}: {self.kind}>"

    async def watch(self, *sensors: str, feedback_period: float = 0.02) -> Goal:
        """Starts a command that exports these sensors, such as ``"force"``, every ``feedback_period`` seconds until it is cancelled; it
        moves nothing, and other commands may drive the device. Each has the name of its sensor in the feedback.

        ``ValueError`` for a name that is not one of a sensor, :class:`RpiError` for a sensor that the device does not have."""
        names = [_identifier(sensor) for sensor in sensors]
        exports = "".join(f"  {name} = {self.name}.{name};\n  export {name};\n" for name in names)
        goal = await self._load("Watch", f"{exports}  finish done when cancel;\n", feedback_period=feedback_period)
        await goal.start()
        return goal

    async def _load(self, name: str, body: str, given: str = "", feedback_period: float = 0.02) -> Goal:
        """Loads a command for this device. Its body is text of the language."""
        module, kind = self._type()
        inputs = f" given ({given})" if given else ""
        text = f"use {module};\ncommand {name} ({_identifier(self.name)}: {kind}){inputs}\nlet\n{body}tel\n"
        return await self._session.load(text, command=name, feedback_period=feedback_period)

    def _type(self) -> tuple[str, str]:
        """Returns the module and the type of the device in programs."""
        if self._joint_count is not None:
            return "motion", f"Arm<<{self._joint_count}>>"
        if self.kind not in _TYPES:
            raise ValueError(f"{self.name}, of the kind {self.kind}, needs a program of its own")
        return _TYPES[self.kind]


class Arm(Device):
    """A robot arm with ``joint_count`` axes."""

    @property
    def joint_count(self) -> int:
        """Number of axes."""
        return self._joint_count or 0

    async def line(self, to: Pose, *, speed: float = 0.25, acceleration: float = 0.5, jerk: float = 5.0) -> Goal:
        """Loads a straight motion of the tool to a pose in the base of the arm, with at most this speed (m/s), acceleration (m/s^2) and
        jerk (m/s^3), and sets its goal. Its results are ``at_goal``, ``stopped`` (on its path, after a cancel) and ``arm_error``; it exports
        ``progress`` from 0 to 1. ``ValueError`` for a bound that is not a positive number."""
        return await self._motion("Line", "to: Pose({arm}.tool in {arm}.base)", to, ("m/s", speed), ("m/s^2", acceleration), ("m/s^3", jerk))

    async def point_to_point(
        self, to: Sequence[float], *, speed: float = math.pi / 4, acceleration: float = math.pi / 2, jerk: float = 5 * math.pi
    ) -> Goal:
        """Loads a motion of all joints to these positions (rad), which arrive at the same time, with at most this speed (rad/s),
        acceleration (rad/s^2) and jerk (rad/s^3) of each. Otherwise as :meth:`line`."""
        units = (("rad/s", speed), ("rad/s^2", acceleration), ("rad/s^3", jerk))
        return await self._motion("PointToPoint", f"to: real[rad]^{self.joint_count}", list(to), *units)

    async def _motion(self, fragment: str, given: str, to: Pose | list[float], *bounds: tuple[str, float]) -> Goal:
        arm = _identifier(self.name)
        limits = zip(("speed", "acceleration", "jerk"), bounds, strict=True)
        statics = "; ".join(f"{name}: {_positive(name, value)}[{unit}]" for name, (unit, value) in limits)
        body = (
            f"  way = {fragment}<<n: {self.joint_count}; {statics}>>({arm}, to);\n"
            f"  {arm}.joints = way.joints;\n"
            "  progress = way.progress;\n"
            "  export progress;\n"
            "  finish at_goal when way.done;\n"
            "  fail stopped when way.stopped;\n"
            f"  fail arm_error when {arm}.error;\n"
        )
        goal = await self._load(fragment + "To", body, given.format(arm=arm))
        await goal.set(to=to)
        return goal


class Gripper(Device):
    """A gripper with two fingers."""

    async def move(self, width: float) -> Goal:
        """Loads a motion of the fingers to an opening in metres, and sets it. Its results are ``at_width``, ``holding`` (an object stops
        the fingers), ``stopped`` (after a cancel) and ``gripper_error``; it exports ``opening`` (m) and ``force`` (N)."""
        own = _identifier(self.name)
        body = (
            f"  {own}.width = width;\n"
            f"  opening = {own}.opening;\n"
            f"  force = {own}.force;\n"
            "  export opening;\n"
            "  export force;\n"
            f"  finish at_width when abs(opening - width) < 0.1[mm] and not {own}.moving;\n"
            f"  finish holding when {own}.holding;\n"
            "  fail stopped when cancel;\n"
            f"  fail gripper_error when {own}.error;\n"
        )
        goal = await self._load("MoveFingers", body, "width: real[m]")
        await goal.set(width=width)
        return goal


def make_device(session: Session, info: DeviceInfo) -> Device:
    """Returns the wrapper for a device, by its kind."""
    if info.joint_count is not None:
        return Arm(session, info)
    return Gripper(session, info) if info.kind == "gripper" else Device(session, info)


def _identifier(name: str) -> str:
    """Returns a name that may stand in a program; ``ValueError`` otherwise."""
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name, re.ASCII):
        raise ValueError(f"{name!r} is not a name in programs")
    return name


def _positive(name: str, value: float) -> str:
    """Returns the literal of a positive number."""
    if not (math.isfinite(value) and value > 0):
        raise ValueError(f"{name} is {value}, not a positive number")
    text = format(Decimal(repr(float(value))), "f")
    return text if "." in text else f"{text}.0"
