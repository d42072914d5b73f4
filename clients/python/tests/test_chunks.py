"""Chunks of a policy against a server: forms of policies, rejected and late chunks, frames, and limits at the seams."""

from __future__ import annotations

import asyncio
import importlib
import math
import os
import subprocess
import sys
import time
import unittest
from collections.abc import AsyncIterator, Awaitable, Callable
from pathlib import Path
from typing import Any

from rpi_client import (
    Arm,
    Chunk,
    ChunkOptions,
    ChunkReport,
    ChunkStream,
    FrameTable,
    Observation,
    Pose,
    Recording,
    RpiError,
    Session,
    State,
    Vector,
    connect,
)

from support import RPI, CellTest, needs, needs_rpi

#: Duration of the tests with a policy at 50 Hz, s: short unless this variable asks for more.
SECONDS = float(os.environ.get("RPI_CHUNK_SECONDS", "1.5"))

EXAMPLE = Path(__file__).resolve().parent.parent / "examples" / "stand_in_policy.py"


def wave(home: list[float], t: float) -> list[float]:
    """Returns joint positions (rad) that begin at rest at time 0 and sway."""
    size = 0.2 * (1 - math.exp(-(t**2)))
    return [position + size * math.sin(2 * t) * (k in (0, 2, 5)) for k, position in enumerate(home)]


class Wave:
    """A policy that sways until an observation is `seconds` old."""

    def __init__(self, seconds: float, rows: int = 30, period: float = 0.02) -> None:
        self.seconds, self.rows, self.period = seconds, rows, period
        self.home: list[float] = []

    def __call__(self, observation: Observation) -> list[list[float]] | None:
        self.home = self.home or observation.commanded
        if observation.server_time > self.seconds:
            return None
        return [wave(self.home, observation.server_time + k * self.period) for k in range(self.rows)]

    async def stream(self, observations: AsyncIterator[Observation]) -> AsyncIterator[Chunk]:
        """The same policy as an async generator function."""
        async for observation in observations:
            rows = self(observation)
            if rows is None:
                return
            yield Chunk(rows, observed=observation.time)


#: A device of the cell with inputs and outputs.
BOX = """
[devices.box]
kind = "digital-io"
inputs = [false, true]
outputs = 2
"""

#: A program that shows its outputs.
OUTPUTS = """command Outputs ()
let
  first_output = IO::OutBoolSensor<<DeviceID: "box", Port: 0>>();
  second_output = IO::OutBoolSensor<<DeviceID: "box", Port: 1>>();
  export first_output, second_output;
  finish done when cancel;
tel
"""

#: A program that switches the first output of the box on.
ON = """use io;
command On (box: DigitalIo<<0, 1>>)
let
  box.set = [true];
  finish done when time > 5[ms];
tel
"""


class Circle:
    """A policy in Cartesian space that moves the tool along a circle until an observation is `seconds` old."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.home: Pose | None = None

    def __call__(self, observation: Observation) -> list[Pose] | None:
        self.home = self.home or observation.values["pose"]
        if observation.server_time > self.seconds:
            return None
        return [self.at(self.home, observation.server_time + 0.02 * k) for k in range(40)]

    @staticmethod
    def at(home: Pose, t: float) -> Pose:
        """Returns the pose at a time (s); it begins at rest."""
        size, (x, y, z) = 0.04 * (1 - math.exp(-(t**2))), home.position
        return Pose(Vector(x - size * math.sin(2 * t), y, z - size * (1 - math.cos(2 * t))), home.orientation)


class ArmTest(CellTest):
    """A test with the arm of a server."""

    async def with_arm(self, work: Callable[[Session, Arm], Awaitable[None]], address: str | None = None) -> None:
        """Runs a test with the arm of a server."""
        async with await connect(address or self.socket) as core, await core.open_session("test") as session:
            arm = (await session.devices())["arm"]
            assert isinstance(arm, Arm)
            await work(session, arm)

    def check(self, report: ChunkReport, least: int) -> None:
        """Checks a report of a motion that the policy has ended. On a machine that is overloaded, chunks may be stale when they arrive."""
        assert report.ending is not None
        self.assertEqual(report.ending.result, "rests", report)
        self.assertGreaterEqual(report.accepted, least, report)
        self.assertEqual(report.superseded, 0, report)
        self.assertLessEqual(set(report.codes), {36}, report)
        self.assertGreater(report.in_force.count, 0)
        self.assertGreaterEqual(report.age.quantile(0.0), -report.clock_uncertainty)


@needs_rpi
class ChunkTest(ArmTest):
    def setUp(self) -> None:
        super().setUp()
        with (self.folder / "cell.toml").open("a", encoding="utf-8") as cell:
            cell.write(BOX)
        self.serve()

    async def test_every_form_of_a_policy_moves_the_arm(self) -> None:
        async def work(_: Session, arm: Arm) -> None:
            options = ChunkOptions(rows=30)
            for form in ("function", "generator", "iterator"):
                policy = Wave(0.3)

                async def iterator() -> AsyncIterator[Chunk]:
                    for _ in range(5):
                        yield Chunk([home] * 10)
                        await asyncio.sleep(0.05)

                async with await arm.open_chunks(options) as stream:
                    assert stream.latest is not None
                    home = stream.latest.commanded
                    forms: dict[str, Any] = {"function": policy, "generator": policy.stream, "iterator": iterator()}
                    report = await asyncio.wait_for(stream.run(forms[form], every=0.05), 10)
                    self.check(report, 1)
                    self.assertEqual(report.inference.count > 0, form != "iterator")
                    # The arm rests at the last row that it has accepted, but for the smoothing.
                    for one, other in zip(stream.latest.commanded, stream._sent[stream.latest.accepted].rows[-1], strict=True):
                        self.assertAlmostEqual(one, other, delta=0.011)

        await self.with_arm(work)

    async def test_rejected_chunks_are_counted_and_the_arm_goes_on(self) -> None:
        async def work(_: Session, arm: Arm) -> None:
            async with await arm.open_chunks(ChunkOptions(rows=10, gripper="hand", observe=["force", "hand.opening"])) as stream:
                first = stream.latest
                assert first is not None
                rows, widths = [first.commanded] * 10, [0.05] * 10
                # The first row is older than the chunk is long.
                await stream.send(Chunk(rows, time.monotonic() - 5.0, widths=[0.08] * 10))
                await asyncio.sleep(0.05)
                await stream.send(Chunk(rows, widths=widths))
                await asyncio.sleep(0.5)
                self.assertEqual((stream.report.accepted, stream.report.rejected, stream.report.codes), (1, 1, {36: 1}))
                for wrong in ([[0.0] * 6] * 3, [[math.nan] * 6] * 10, [[0.0] * 6] * 11):
                    with self.assertRaises(ValueError):
                        await stream.send(Chunk(wrong, widths=widths))
                with self.assertRaisesRegex(ValueError, "the gripper of this stream needs an opening"):
                    await stream.send(rows)
                with self.assertRaisesRegex(ValueError, "there is no input velocities"):
                    await stream.send(Chunk(rows, velocities=rows, widths=widths))
                self.assertEqual(stream.report.sent, 2)
                # A chunk that was not sent has no number.
                self.assertEqual(await stream.send(Chunk(rows, widths=widths)), 3)
                await asyncio.sleep(0.1)
                assert stream.latest is not None
                self.assertEqual((stream.latest.accepted, len(stream.latest.values["force"].torque)), (3, 3))
                self.assertAlmostEqual(stream.latest.values["hand_opening"], 0.05, delta=1e-3)

        await self.with_arm(work)

    async def test_appended_chunks_and_velocities(self) -> None:
        async def work(_: Session, arm: Arm) -> None:
            home: list[float] = []

            async def policy(observations: AsyncIterator[Observation]) -> AsyncIterator[Chunk]:
                async for observation in observations:
                    home.extend([] if home else observation.commanded)
                    for k in range(4):
                        times = [0.02 * row for row in range(10 * k, 10 * k + 10)]
                        positions = [[q + 0.05 * t**2 for q in home] for t in times]
                        yield Chunk(positions, velocities=[[0.1 * t] * 6 for t in times], append=k > 0)
                    return

            options = ChunkOptions(rows=10, velocities=True)
            with self.assertRaisesRegex(ValueError, "needs backlog='queue'"):
                await arm.chunks(policy, options)
            home.clear()
            report = await asyncio.wait_for(arm.chunks(policy, options, backlog="queue"), 10)
            self.check(report, 4)
            self.assertEqual((report.sent, report.dropped), (4, 0))
            async with await arm.watch("commanded") as watched:
                async for feedback in watched.feedback():
                    if feedback.values:
                        break
            for one, other in zip(watched.latest.values["commanded"], home, strict=True):
                self.assertAlmostEqual(one, other + 0.05 * 0.78**2, delta=1e-3)

        await self.with_arm(work)

    async def test_appended_chunks_wait_for_the_room_that_the_arm_has(self) -> None:
        count, rows = 12, 50

        async def work(_: Session, arm: Arm) -> None:
            home: list[float] = []

            async def policy(observations: AsyncIterator[Observation]) -> AsyncIterator[Chunk]:
                async for observation in observations:
                    home.extend(observation.commanded)
                    break
                for k in range(count):
                    times = [0.01 * row for row in range(rows * k, rows * k + rows)]
                    # More rows than the arm keeps, sent at once: a chunk that is lost would shift all behind it.
                    yield Chunk([[home[0] + 0.02 * t**2 / (1.0 + t), *home[1:]] for t in times], append=k > 0)

            options = ChunkOptions(rows=rows, period=0.01)
            report = await asyncio.wait_for(arm.chunks(policy, options, backlog="queue"), 20)
            self.assertEqual((report.sent, report.accepted, report.codes), (count, count, {}), report)
            t = 0.01 * (rows * count - 1)
            async with await arm.watch("commanded") as watched:
                async for feedback in watched.feedback():
                    if feedback.values:
                        break
            self.assertAlmostEqual(watched.latest.values["commanded"][0], home[0] + 0.02 * t**2 / (1.0 + t), delta=1e-3)

        await self.with_arm(work)

    async def test_what_a_stream_needs_is_checked_before_it_is_sent(self) -> None:
        async def work(_: Session, arm: Arm) -> None:
            async with await arm.open_chunks(ChunkOptions(rows=10, velocities=True)) as stream:
                assert stream.latest is not None
                rows = [stream.latest.commanded] * 10
                still = [[0.0] * len(rows[0])] * 10
                with self.assertRaisesRegex(ValueError, "velocities: this stream needs a velocity at each row"):
                    await stream.send(rows)
                for frozen in (-1, 11):
                    with self.assertRaisesRegex(ValueError, f"frozen is {frozen}, not from 0 to 10"):
                        await stream.send(Chunk(rows, velocities=still, frozen=frozen))
                with self.assertRaisesRegex(ValueError, "every is -1.0"):
                    await stream.run(lambda _: None, every=-1.0)
                self.assertEqual(stream.report.sent, 0)

        await self.with_arm(work)

    async def test_chunks_of_poses(self) -> None:
        """A policy in Cartesian space: the tool follows a circle of 40 mm, and chunks out of reach are rejected."""

        async def work(_: Session, arm: Arm) -> None:
            circle = Circle(0.8)
            with self.assertRaisesRegex(ValueError, "chunks of poses have no velocities"):
                await arm.open_chunks(ChunkOptions(poses=True, velocities=True))
            options = ChunkOptions(rows=40, poses=True, observe=["pose"])
            async with await arm.open_chunks(options) as stream:
                report = await asyncio.wait_for(stream.run(circle, every=0.05), 10)
                self.check(report, 3)
                assert stream.latest is not None and circle.home is not None
                at, last = stream.latest.values["pose"], stream._sent[stream.latest.accepted].rows[-1]
            # The arm rests at the last row, but for the smoothing of the joints; the way there is not straight.
            self.assertLess(math.dist(at.position, last[:3]), 0.01)
            self.assertGreater(math.dist(at.position, circle.home.position), 0.02)
            async with await arm.open_chunks(options) as stream:
                await stream.send([Pose(Vector(9.0, 0.0, 0.0), at.orientation)] * 10)
                await asyncio.sleep(0.2)
                self.assertEqual((stream.report.accepted, stream.report.rejected), (0, 1))
                with self.assertRaisesRegex(ValueError, "poses: a row of 7 numbers"):
                    await stream.send([[0.0] * 6] * 10)
                with self.assertRaisesRegex(ValueError, "not a unit quaternion"):
                    await stream.send([[0.0] * 7] * 10)

        await self.with_arm(work)

    async def test_ensembles_and_frozen_rows(self) -> None:
        """Where two chunks overlap, the weight of the one before and frozen rows decide where the arm ends."""

        async def work(_: Session, arm: Arm) -> None:
            ends = {}
            for previous, frozen in ((0.0, 0), (0.5, 0), (0.0, 50)):
                options = ChunkOptions(rows=60, period=0.02, previous=previous, smoothing=0.001)
                async with await arm.open_chunks(options) as stream:
                    assert stream.latest is not None
                    home = stream.latest.commanded
                    now = time.monotonic()
                    await stream.send(Chunk([home] * 60, observed=now))
                    # Every row of the second chunk overlaps one of the first.
                    moved = [home[0] + 0.02, *home[1:]]
                    await asyncio.sleep(0.1)
                    await stream.send(Chunk([moved] * 50, observed=now, frozen=frozen))
                    await asyncio.sleep(1.5)
                    self.assertEqual(stream.report.accepted, 2)
                    ends[previous, frozen] = stream.latest.commanded[0] - home[0]
            for key, expected in (((0.0, 0), 0.02), ((0.5, 0), 0.01), ((0.0, 50), 0.0)):
                self.assertAlmostEqual(ends[key], expected, delta=0.0015, msg=f"{ends}")

        await self.with_arm(work)

    async def test_other_devices_follow_the_rows(self) -> None:
        async def work(_: Session, arm: Arm) -> None:
            with self.assertRaisesRegex(ValueError, "is not a unit of programs"):
                await arm.open_chunks(ChunkOptions(channels={"belt.speed": "m/s]; x"}))
            options = ChunkOptions(rows=60, channels={"belt.speed": "m/s"}, observe=["belt.velocity"])
            async with await arm.open_chunks(options) as stream:
                assert stream.latest is not None
                self.assertEqual(stream.latest.values["belt_velocity"], 0.0)
                rows = [stream.latest.commanded] * 60
                with self.assertRaisesRegex(ValueError, "channels: belt_speed of this stream needs a value"):
                    await stream.send(rows)
                with self.assertRaisesRegex(ValueError, "belt.speed: 60 are needed, and there are 4"):
                    await stream.send(Chunk(rows, channels={"belt.speed": [0.0] * 4}))
                # The belt runs from row 25 on: half a second later.
                speeds = [0.0] * 25 + [0.1] * 35
                await stream.send(Chunk(rows, channels={"belt.speed": speeds}))
                seen = []
                async for observation in stream.observations():
                    seen.append((observation.remaining, observation.values["belt_velocity"]))
                    if observation.accepted and observation.remaining < 0.6:
                        break
                # A loaded machine may leave out the first observations, but the last row holds until the next chunk.
                early = [velocity for remaining, velocity in seen if remaining > 0.75]
                self.assertLessEqual(set(early), {0.0})
                async for observation in stream.observations():
                    if observation.values["belt_velocity"] == 0.1:
                        break

        await self.with_arm(work)

    async def test_outputs_follow_the_rows(self) -> None:
        async def work(session: Session, arm: Arm) -> None:
            with self.assertRaisesRegex(ValueError, r"channels: box.set\[0\] is needed, too: outputs 0 to 1 are driven together"):
                await arm.open_chunks(ChunkOptions(channels={"box.set[1]": "bool"}))
            with self.assertRaisesRegex(ValueError, "box has digital and analogue outputs"):
                await arm.open_chunks(ChunkOptions(channels={"box.set[0]": "bool", "box.set[1]": ""}))
            with self.assertRaisesRegex(ValueError, r"channels: box.set is all outputs of box; name them one by one, such as box.set\[0\]"):
                await arm.open_chunks(ChunkOptions(channels={"box.set": "bool"}))
            with self.assertRaisesRegex(ValueError, r"observe: box.get is all inputs of box; name them one by one, such as box.get\[0\]"):
                await arm.open_chunks(ChunkOptions(observe=["box.get"]))
            channels = {"box.set[1]": "bool", "box.set[0]": "bool"}
            options = ChunkOptions(rows=40, channels=channels, observe=["box.get[1]"])
            outputs = await session.load(OUTPUTS)
            # Before the first chunk, outputs keep their values.
            on = await session.load(ON)
            await on.start()
            await on.result()
            async with await arm.open_chunks(options) as stream, outputs:
                await outputs.start()
                assert stream.latest is not None
                self.assertEqual(stream.latest.values["box_get_1"], True)
                rows = [stream.latest.commanded] * 40
                with self.assertRaisesRegex(ValueError, "channels: box_set_1 of this stream needs a value"):
                    await stream.send(Chunk(rows, channels={"box.set[0]": [0.0] * 40}))
                seen: list[object] = []
                async for feedback in outputs.feedback():
                    if feedback.values:
                        seen.append(feedback.values["first_output"])
                        break
                await stream.send(Chunk(rows, channels={"box.set[1]": [False] * 5 + [True] * 35, "box.set[0]": [0.0] * 40}))
                async for feedback in outputs.feedback():
                    if feedback.values:
                        seen.append(feedback.values["first_output"])
                        if feedback.values["second_output"]:
                            break
                self.assertEqual([seen[0], seen[-1]], [True, False], seen)

        await self.with_arm(work)

    async def test_outputs_are_off_at_rest(self) -> None:
        """The arm rests at the last row, because no chunk follows: the first output goes out, the second one stays on."""

        async def work(session: Session, arm: Arm) -> None:
            channels = {"box.set[0]": "bool", "box.set[1]": "bool"}
            with self.assertRaisesRegex(ValueError, r"off_at_rest: torch.set\[0\] is no truth value among the channels"):
                await arm.open_chunks(ChunkOptions(channels=channels, off_at_rest=["torch.set[0]"]))
            options = ChunkOptions(rows=40, channels=channels, off_at_rest=["box.set[0]"])
            outputs = await session.load(OUTPUTS)
            async with await arm.open_chunks(options) as stream, outputs:
                await outputs.start()
                assert stream.latest is not None
                home = stream.latest.commanded
                rows = [[home[0] + 0.001 * k, *home[1:]] for k in range(40)]
                await stream.send(Chunk(rows, channels={name: [True] * 40 for name in channels}))
                seen: list[tuple[object, object]] = []
                async for feedback in outputs.feedback():
                    if feedback.values:
                        seen.append((feedback.values["first_output"], feedback.values["second_output"]))
                        if ((True, True) in seen and seen[-1] == (False, True)) or len(seen) > 5000:
                            break
                self.assertIn((True, True), seen)
                self.assertEqual(seen[-1], (False, True))

        await self.with_arm(work)

    async def test_a_limit_that_binds_is_reported(self) -> None:
        """A policy that asks the third joint for more than its velocity."""

        async def work(_: Session, arm: Arm) -> None:
            async def fast(observations: AsyncIterator[Observation]) -> AsyncIterator[Chunk]:
                async for observation in observations:
                    home = observation.commanded
                    turn = [0.8 * min((0.02 * k / 0.3) ** 2, 1.0) for k in range(50)]
                    yield Chunk([[*home[:2], home[2] - at, *home[3:]] for at in turn])
                    return

            report = await asyncio.wait_for(arm.chunks(fast, ChunkOptions(rows=50)), 10)
            self.check(report, 1)
            self.assertGreater(sum(report.limits.values()), 5, report)
            self.assertEqual({limit.joint for limit in report.limits}, {2}, report)
            self.assertIn("of joint 2 in ", str(report))
            self.assertGreater(report.smoothed, 1e-4)

        await self.with_arm(work)

    async def test_an_error_of_the_policy_stops_the_arm(self) -> None:
        async def work(_: Session, arm: Arm) -> None:
            sway = Wave(10.0, rows=100)

            def broken(observation: Observation) -> list[list[float]] | None:
                if observation.server_time > 0.5:
                    raise ArithmeticError("of the policy")
                return sway(observation)

            stream = await arm.open_chunks(ChunkOptions(rows=100))
            with self.assertRaisesRegex(ArithmeticError, "of the policy"):
                async with stream:
                    await stream.run(broken, every=0.1)
            self.assertEqual((await stream.goal.result()).result, "stopped")
            # The arm is free, and at rest.
            async with await arm.open_chunks(ChunkOptions(rows=100)) as stream:
                running = asyncio.create_task(stream.run(Wave(10.0, rows=100), every=0.1))
                await asyncio.sleep(0.3)
                running.cancel()
                with self.assertRaises(asyncio.CancelledError):
                    await running
                self.assertEqual((await stream.goal.result()).result, "stopped")
                with self.assertRaises(RpiError):
                    await stream.send([[0.0] * 6] * 10)

        await self.with_arm(work)

    async def test_the_end_of_the_command_ends_the_policy(self) -> None:
        async def work(session: Session, arm: Arm) -> None:
            sway = Wave(10.0)
            async with await connect(self.socket) as core:

                async def policy(observation: Observation) -> Any:
                    if observation.server_time > 0.4:
                        await core.emergency_stop("the test")
                    return sway(observation)

                report = await asyncio.wait_for(arm.chunks(policy, ChunkOptions(rows=30), every=0.05), 10)
            assert report.ending is not None
            self.assertEqual(report.ending.why, "emergency stop")

        await self.with_arm(work)

    async def test_a_program_of_the_user(self) -> None:
        async def work(session: Session, arm: Arm) -> None:
            text = await arm.chunk_program(ChunkOptions(rows=30))
            marked = text.replace("  finish rests", "  reach = distance(arm.pose, own_tool) / 1[m]; export reach;\n  finish rests", 1)
            goal = await session.load(marked.replace("use motion", "use geometry, motion"), command="FollowPolicy", feedback_period=0.01)
            async with ChunkStream(goal) as stream:
                report = await asyncio.wait_for(stream.run(Wave(0.3), every=0.05), 10)
                self.check(report, 1)
                assert stream.latest is not None
                self.assertGreater(stream.latest.values["reach"], 0.1)
            lacking = await session.load("command Nothing () let finish done when time > 1[s]; tel")
            with self.assertRaisesRegex(ValueError, "Nothing has no number, count, observed, positions, clock"):
                ChunkStream(lacking)

        await self.with_arm(work)

    @needs("pyarrow")
    async def test_frames_have_observations_and_actions_side_by_side(self) -> None:
        file = self.folder / "frames.parquet"

        async def work(_: Session, arm: Arm) -> None:
            with FrameTable(file, episode=7) as frames:
                options = ChunkOptions(rows=30, observe=["singularity_distance"])
                report = await arm.chunks(Wave(0.6), options, every=0.05, frames=frames)
            self.check(report, 3)
            self.assertEqual(report.lost_frames, 0)

        await self.with_arm(work)
        rows = importlib.import_module("pyarrow.parquet").read_table(file).to_pylist()
        self.assertGreater(len(rows), 20)
        self.assertEqual([row["frame_index"] for row in rows], list(range(len(rows))))
        self.assertEqual({row["episode_index"] for row in rows}, {7})
        times = [row["timestamp"] for row in rows]
        self.assertEqual((times[0], times), (0.0, sorted(times)))
        with_action = [row for row in rows if row["action"] is not None]
        self.assertGreater(len(with_action), 10)
        for row in with_action:
            self.assertEqual((len(row["action"]), len(row["observation.state"]), len(row["observation.pose"])), (6, 6, 7))
            self.assertGreater(row["chunk"], 0)
            self.assertIsInstance(row["observation.singularity_distance"], float)
            # The arm is between this row and the next one, but for the smoothing.
            if row["late"] or row["lag"] > 0.005:
                continue
            for wanted, commanded in zip(row["action"], row["commanded"], strict=True):
                self.assertAlmostEqual(wanted, commanded, delta=0.03)

    @needs("pyarrow")
    async def test_the_example_runs(self) -> None:
        file = self.folder / "example.parquet"
        command = [sys.executable, "-W", "error", str(EXAMPLE), self.socket, "--seconds", "1", "--frames", str(file)]
        paths = {"PYTHONPATH": os.pathsep.join(sys.path)}
        done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **paths}, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("ended with rests", done.stdout)
        self.assertRegex(done.stdout, r"(?m)^from sent to in force: median [0-9.]+ ms")
        self.assertGreater(file.stat().st_size, 1000)


@needs_rpi
class BusyTest(ArmTest):
    """A policy at 50 Hz whose event loop is busy, recorded by the server."""

    def setUp(self) -> None:
        super().setUp()
        self.file = self.folder / "out.mcap"
        self.server = self.serve("--record", str(self.file))

    @needs("mcap")
    async def test_a_busy_loop_over_the_socket(self) -> None:
        await self.busy("socket")

    @needs("mcap")
    async def test_a_busy_loop_over_the_websocket(self) -> None:
        await self.busy("websocket")

    async def busy(self, kind: str) -> None:
        """A policy at 50 Hz, whose event loop is blocked for 5 to 40 ms again and again: all limits are kept in every cycle."""
        reports: list[ChunkReport] = []

        async def block() -> None:
            for k in range(1_000_000):
                time.sleep(0.005 + 0.035 * (k % 7 == 0))
                await asyncio.sleep(0.001)

        async def work(_: Session, arm: Arm) -> None:
            async with await arm.watch("limits") as watched:
                async for feedback in watched.feedback():
                    if feedback.values:
                        break
            limits.update(watched.latest.values["limits"])
            # The loop of the tests reports what blocks it.
            asyncio.get_running_loop().set_debug(False)
            blocking = asyncio.create_task(block())
            reports.append(await asyncio.wait_for(arm.chunks(Wave(SECONDS, rows=50), ChunkOptions(rows=50), every=0.02), SECONDS + 20))
            blocking.cancel()

        limits: dict[str, list[float]] = {}
        await self.with_arm(work, self.socket if kind == "socket" else f"ws://127.0.0.1:{self.port}")
        self.server.terminate()
        self.server.wait()
        (report,) = reports
        print(f"\nbusy event loop, {kind}, {SECONDS:g} s:\n{report}", file=sys.stderr)
        assert report.ending is not None
        # On a machine that is overloaded chunks are few, and may be late; the limits hold there too.
        self.assertEqual(report.ending.result, "rests")
        self.assertGreater(report.accepted, 5 * SECONDS)
        self.assertEqual(report.accepted + report.rejected, report.sent)
        self.check_seams(Recording(self.file), limits)

    def check_seams(self, recording: Recording, limits: dict[str, list[float]]) -> None:
        """Checks velocity, acceleration and jerk of the recorded set-points in every cycle."""
        table = recording.table("/set_points/arm", "joints")
        cycles = table["cycle"]
        # On a machine that is overloaded the writer of the recording loses ticks, and differences across a gap mean nothing.
        self.assertGreater(len(cycles), 500 * SECONDS)
        gaps = [k for k in range(1, len(cycles)) if cycles[k] != cycles[k - 1] + 1]
        if not recording.lost_ticks:
            self.assertEqual(gaps, [])
        parts = list(zip([0, *gaps], [*gaps, len(cycles)], strict=True))
        moved = 0.0
        for joint in range(6):
            joints = table[f"joints[{joint}]"]
            moved += max(joints) - min(joints)
            for start, end in parts:
                self.check_part(joint, joints[start:end], limits)
        self.assertGreater(moved, 0.2)

    def check_part(self, joint: int, values: list[float], limits: dict[str, list[float]]) -> None:
        """Checks the positions (rad) of a joint in consecutive cycles."""
        for order, name in enumerate(("velocity", "acceleration", "jerk"), 1):
            values = [1000 * (after - before) for before, after in zip(values, values[1:])]
            most = max(map(abs, values), default=0.0)
            self.assertLessEqual(most, limits[name][joint] * (1 + 1e-6) + 1e-14 * 2000**order, f"{name} of joint {joint}")


if __name__ == "__main__":
    unittest.main()
