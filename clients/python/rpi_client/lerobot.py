"""A robot with the shape of the class ``Robot`` of LeRobot, for teleoperation, recording and policies that return single actions.

Features are ``joint_1.pos`` (rad) for each joint, ``gripper.pos`` (opening in m) with a gripper, and the names of the cameras. This module needs nothing of
LeRobot. For policies that return chunks, :meth:`rpi_client.Arm.chunks` is better: it has their time stamps, and the arm knows the next rows.
"""

from __future__ import annotations

import asyncio
import concurrent.futures
import math
import threading
import time
from collections.abc import Coroutine, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, TypeVar

from ._action_program import action_program
from ._core import Core, connect
from ._devices import Arm
from ._frames import FrameTable
from ._goal import Goal
from ._states import State

_Result = TypeVar("_Result")

#: Longest time that a request may take, s.
_LONGEST = 20.0


class Camera(Protocol):
    """A camera with the shape of LeRobot's class of this name, as far as a robot uses it."""

    height: int | None
    width: int | None

    def connect(self) -> None: ...
    def disconnect(self) -> None: ...
    def async_read(self) -> Any: ...


@dataclass
class RpiRobotConfig:
    """Where the robot is, and how it moves.

    ``address`` and ``token`` are those of :func:`rpi_client.connect`, ``arm`` and ``gripper`` names of devices of the cell, ``joints`` the number of axes.
    ``fps`` is the rate of the actions (1/s). ``speed`` (rad/s), ``acceleration`` (rad/s^2) and ``jerk`` (rad/s^3) bound each joint beside its own limits.
    ``cameras`` are connected with the robot. ``frames`` is a Parquet file that gets a row for each action, with the observation before it.
    ``id`` and ``calibration_dir`` are there because LeRobot sets them; the calibration is that of the cell."""

    address: str = "rpi.sock"
    id: str | None = None
    calibration_dir: Path | None = None
    token: str | None = None
    arm: str = "arm"
    joints: int = 6
    gripper: str | None = None
    fps: float = 30.0
    speed: float = math.pi
    acceleration: float = 4 * math.pi
    jerk: float = 80 * math.pi
    cameras: dict[str, Camera] = field(default_factory=dict)
    frames: Path | None = None


class RpiRobot:
    """A robot of an RPI cell, used like any robot of LeRobot:

        with RpiRobot(RpiRobotConfig("rpi.sock", joints=7)) as robot:
            observation = robot.get_observation()
            robot.send_action({name: observation[name] for name in robot.action_features})

    Its methods may be called from any thread, also where an event loop runs. Those that need a connection raise ``ConnectionError`` without one."""

    config_class = RpiRobotConfig
    name = "rpi"

    def __init__(self, config: RpiRobotConfig) -> None:
        self.config = config
        self.robot_type = self.name
        self.id = config.id
        self.calibration_dir = config.calibration_dir
        self.calibration: dict[str, Any] = {}
        self.cameras = config.cameras
        self._loop = _LoopThread()
        self._core: Core | None = None
        self._goal: Goal | None = None
        self._frames: FrameTable | None = None
        self._number = 0
        self._seen: dict[str, Any] = {}

    def __str__(self) -> str:
        return f"{self.id} {type(self).__name__}"

    def __enter__(self) -> RpiRobot:
        self.connect()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.disconnect()

    @property
    def observation_features(self) -> dict[str, Any]:
        """The names of the observations with their types; for cameras the shape of an image."""
        cameras = {name: (camera.height, camera.width, 3) for name, camera in self.cameras.items()}
        return {**self.action_features, **cameras}

    @property
    def action_features(self) -> dict[str, Any]:
        """The names of the actions with their types."""
        gripper = {} if self.config.gripper is None else {"gripper.pos": float}
        return {**{f"joint_{k + 1}.pos": float for k in range(self.config.joints)}, **gripper}

    @property
    def is_connected(self) -> bool:
        """Whether the arm follows actions, and all cameras are connected."""
        follows = self._goal is not None and self._goal.latest.state is State.RUNNING
        return follows and all(getattr(camera, "is_connected", True) for camera in self.cameras.values())

    @property
    def is_calibrated(self) -> bool:
        """True: the cell has the calibration of its robots."""
        return True

    def calibrate(self) -> None:
        """Does nothing: the cell has the calibration of its robots."""

    def configure(self) -> None:
        """Does nothing: the description of the cell configures its robots."""

    def connect(self, calibrate: bool = True) -> None:
        """Connects to the server and the cameras, and starts the command that follows actions; the arm stays where it is. ``calibrate`` has no effect.
        ``ConnectionError`` if it is connected or the server cannot be reached, ``ValueError`` if the cell does not have these devices."""
        if self.is_connected:
            raise ConnectionError(f"{self} is connected already")
        self._loop.start()
        try:
            self._loop.run(self._start())
            for camera in self.cameras.values():
                camera.connect()
            if self.config.frames is not None:
                self._frames = FrameTable(self.config.frames)
            self.configure()
        except BaseException:
            self._release()
            raise

    def get_observation(self) -> dict[str, Any]:
        """Returns the measured joint positions (rad), the opening of the gripper (m), and the newest image of each camera."""
        values = self._followed().latest.values
        observation: dict[str, Any] = dict(zip(self.action_features, values["position"], strict=False))
        if self.config.gripper is not None:
            observation["gripper.pos"] = values["opening"]
        self._seen = dict(observation)
        return {**observation, **{name: camera.async_read() for name, camera in self.cameras.items()}}

    def send_action(self, action: dict[str, Any]) -> dict[str, Any]:
        """Sends an action and returns it as it was sent, with joint positions within the ranges of the joints. ``KeyError`` for a feature that is missing,
        ``ValueError`` for a number that is not finite."""
        goal = self._followed()
        wanted = {name: _finite(name, action[name]) for name in self.action_features}
        joints = [name for name in wanted if name != "gripper.pos"]
        limits = goal.latest.values
        for name, lower, upper in zip(joints, limits["lower"], limits["upper"], strict=True):
            wanted[name] = min(max(wanted[name], lower), upper)
        self._number += 1
        values: dict[str, Any] = {"number": self._number, "target": [wanted[name] for name in joints]}
        if self.config.gripper is not None:
            values["width"] = wanted["gripper.pos"]
        self._loop.run(goal.set(**values))
        if self._frames is not None:
            self._frames.add(time.monotonic(), {"state": self._numbers(self._seen)}, self._numbers(wanted))
        return wanted

    def disconnect(self) -> None:
        """Stops the arm on its path, and disconnects from the server and the cameras. ``ConnectionError`` if it is not connected."""
        self._followed()
        self._release()

    def _followed(self) -> Goal:
        """Returns the running command. ``ConnectionError`` with the reason if there is none."""
        if self._goal is None:
            raise ConnectionError(f"{self} is not connected")
        return self._goal

    def _numbers(self, features: Mapping[str, Any]) -> list[float]:
        """Returns the numbers of an observation or action in the order of the features; empty before the first observation."""
        return [features[name] for name in self.action_features if name in features]

    async def _start(self) -> None:
        """Loads and starts the command, and waits for its first values."""
        config = self.config
        self._core = await connect(config.address, token=config.token)
        session = await self._core.open_session(f"lerobot {config.id or config.arm}")
        devices = await session.devices()
        arm = devices.get(config.arm)
        if not isinstance(arm, Arm) or arm.joint_count != config.joints:
            raise ValueError(f"the cell has no arm {config.arm} with {config.joints} axes; there are: {', '.join(map(repr, devices.values()))}")
        bounds = {"speed": (config.speed, "rad/s"), "acceleration": (config.acceleration, "rad/s^2"), "jerk": (config.jerk, "rad/s^3")}
        text = action_program(config.arm, config.joints, config.gripper, 1.0 / config.fps, bounds)
        self._goal = goal = await session.load(text, command="FollowActions", feedback_period=0.005)
        await goal.start()
        async for feedback in goal.feedback():
            if "position" in feedback.values:
                return
        raise ConnectionError(f"the command has ended at once: {await goal.result()}")

    def _release(self) -> None:
        """Ends what is connected: the command first, so that the arm has stopped when the cameras are gone."""
        goal, core, frames = self._goal, self._core, self._frames
        self._goal, self._core, self._frames = None, None, None
        try:
            if core is not None:
                self._loop.run(_end(core, goal))
        finally:
            self._loop.stop()
            for camera in self.cameras.values():
                if getattr(camera, "is_connected", True):
                    camera.disconnect()
            if frames is not None:
                frames.close()


class _LoopThread:
    """An event loop on a thread of its own. LeRobot's loop is synchronous, and must not delay the connection while it computes."""

    def __init__(self) -> None:
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="rpi", daemon=True)
        self._thread.start()

    def run(self, work: Coroutine[Any, Any, _Result]) -> _Result:
        """Runs a coroutine on the loop and returns its result. ``ConnectionError`` if it takes too long."""
        assert self._loop is not None
        future = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            return future.result(_LONGEST)
        except concurrent.futures.TimeoutError:
            future.cancel()
            raise ConnectionError(f"the control core has not answered for {_LONGEST:g} s") from None

    def stop(self) -> None:
        if self._loop is None or self._thread is None:
            return
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()
        self._loop, self._thread = None, None


async def _end(core: Core, goal: Goal | None) -> None:
    """Stops and unloads a command, and closes the connection."""
    async with core:
        if goal is not None:
            async with goal:
                pass


def _finite(name: str, value: Any) -> float:
    """Returns a number of an action, which may be one of numpy or torch."""
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{name} is {number}, not a finite number")
    return number
