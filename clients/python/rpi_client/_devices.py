"""Devices of the cell: commands for usual motions, and their sensors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ._chunk_program import ChunkOptions, chunk_program
from ._chunk_stream import ChunkStream
from ._policy import Backlog, Policy
from ._text import identifier, real_text
from ._values import Pose

if TYPE_CHECKING:
    from ._chunk_report import ChunkReport
    from ._core import DeviceInfo
    from ._frames import FrameTable
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
        names = [identifier(sensor) for sensor in sensors]
        exports = "".join(f"  {name} = {self.name}.{name};\n  export {name};\n" for name in names)
        goal = await self._load("Watch", f"{exports}  finish done when cancel;\n", feedback_period=feedback_period)
        await goal.start()
        return goal

    async def _load(self, name: str, body: str, given: str = "", feedback_period: float = 0.02) -> Goal:
        """Loads a command for this device. Its body is text of the language."""
        module, kind = self.program_type()
        inputs = f" given ({given})" if given else ""
        text = f"use {module};\ncommand {name} ({identifier(self.name)}: {kind}){inputs}\nlet\n{body}tel\n"
        return await self._session.load(text, command=name, feedback_period=feedback_period)

    def has_program_type(self) -> bool:
        """Whether :meth:`program_type` knows the kind of the device."""
        return self._joint_count is not None or self.kind in _TYPES

    def program_type(self) -> tuple[str, str]:
        """Returns the module and the type of the device in programs. ``ValueError`` for a kind without one."""
        if self._joint_count is not None:
            return "motion", f"Arm<<{self._joint_count}>>"
        if not self.has_program_type():
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

    async def chunk_program(self, options: ChunkOptions = ChunkOptions()) -> str:
        """Returns the text of the program of :meth:`open_chunks`. A program made from it can have further devices, outputs and results; load it
        and give its command to a :class:`ChunkStream`. ``ValueError`` for options that are out of range and for unknown devices."""
        devices = await self._session.devices()
        types = {name: device.program_type() for name, device in devices.items() if device.has_program_type()}
        types.update({name: ("io", "") for name, device in devices.items() if device.kind == "io"})
        return chunk_program(self.name, self.joint_count, types, options)

    async def open_chunks(
        self, options: ChunkOptions = ChunkOptions(), *, feedback_period: float = 0.01, frames: FrameTable | None = None
    ) -> ChunkStream:
        """Loads a command that follows the chunks of a policy. Its ``async with`` block starts it, and stops the arm on its path at the end:

            async with await arm.open_chunks(ChunkOptions(rows=30, period=0.04)) as stream:
                await stream.send(rows)

        ``feedback_period`` is the time between two observations (s). ``frames`` gets a row for each of them."""
        text = await self.chunk_program(options)
        goal = await self._session.load(text, command="FollowPolicy", feedback_period=feedback_period)
        return ChunkStream(goal, frames, options.period)

    async def chunks(
        self,
        policy: Policy,
        options: ChunkOptions = ChunkOptions(),
        *,
        every: float = 0.0,
        backlog: Backlog = "latest",
        depth: int = 4,
        feedback_period: float = 0.01,
        frames: FrameTable | None = None,
    ) -> ChunkReport:
        """Lets a policy move the arm: it gets observations and returns chunks, which the arm takes over in motion. Returns when the policy has
        ended and the arm rests, or when the command has ended otherwise; see ``ending`` of the report.

        ``policy`` is a function or coroutine function of an :class:`Observation` that returns a :class:`Chunk`, its rows alone, or None to end;
        a plain function runs in a thread. Or it is an async generator function that gets all observations and yields chunks, or an async
        iterator of chunks. It gets the newest observation, at most once in ``every`` seconds.

        ``backlog`` is what becomes of a chunk that waits because the server has not answered the one before: with ``"latest"`` a
        newer one replaces it, with ``"queue"`` up to ``depth`` chunks wait in order, and then the policy waits. A chunk that is appended waits, too, until the arm has room for
        it: 400 rows. If the arm rejects one of them, the next one raises :class:`RpiError`. Otherwise as
        :meth:`open_chunks`."""
        async with await self.open_chunks(options, feedback_period=feedback_period, frames=frames) as stream:
            return await stream.run(policy, every=every, backlog=backlog, depth=depth)

    async def _motion(self, fragment: str, given: str, to: Pose | list[float], *bounds: tuple[str, float]) -> Goal:
        arm = identifier(self.name)
        limits = zip(("speed", "acceleration", "jerk"), bounds, strict=True)
        statics = "; ".join(f"{name}: {real_text(name, value)}[{unit}]" for name, (unit, value) in limits)
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
        own = identifier(self.name)
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
