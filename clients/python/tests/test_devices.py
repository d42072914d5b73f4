"""Typed inputs and exports of programs, and wrappers of devices, against a server."""

from __future__ import annotations

import asyncio
import unittest
from collections.abc import AsyncIterator
from enum import IntEnum
from typing import Any

from rpi_client import Arm, Cause, Device, Feedback, Gripper, OnLoss, Pose, RpiError, State, Vector, connect

from support import CellTest, needs, needs_rpi

ECHO = """
type Mode = enum { Off, On, Fault };
type Part = struct { mass: real[kg]; count: int };
command Echo given (goal: Pose; gain: real[mm]; mode: Mode; joints: real[rad]^3; parts: Part^2; on: bool)
let
  goal_out = goal; gain_out = gain; mode_out = mode; joints_out = joints; parts_out = parts;
  sometimes = gain when on;
  export goal_out; export gain_out; export mode_out; export joints_out; export parts_out; export sometimes;
  finish done when time >= 20[ms];
tel
"""


class Mode(IntEnum):
    OFF = 0
    ON = 1
    FAULT = 2


@needs_rpi
class ServerTest(CellTest):
    def setUp(self) -> None:
        super().setUp()
        self.serve()

    async def test_values_keep_their_types_and_bits(self) -> None:
        async with await connect(self.socket) as core, await core.open_session("test") as session:
            goal = await session.load(ECHO, enums={"mode": Mode, "mode_out": Mode})
            self.assertEqual((goal.title, goal.results), ("Echo", ("done",)))
            self.assertEqual((goal.inputs["goal"].scalar, goal.inputs["parts[1].count"].scalar), ("Pose", "int"))
            parts = [{"mass": 0.1, "count": 2**62}, {"mass": 1e-300, "count": -1}]
            pose = Pose.from_euler(0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
            await goal.set(goal=pose, gain=0.1, mode=Mode.FAULT, joints=(1, 2.5, -0.0), parts=parts, on=False)
            await goal.start()
            ending = await goal.result()
            self.assertIs(ending.cause, Cause.RESULT)
            values = ending.values
            self.assertEqual((values["gain_out"], values["joints_out"], values["parts_out"]), (0.1, [1.0, 2.5, -0.0], parts))
            self.assertIs(values["mode_out"], Mode.FAULT)
            self.assertNotIn("sometimes", values)
            back = values["goal_out"]
            self.assertEqual(back.position, pose.position)
            for one, other in zip(back.orientation, pose.orientation):
                self.assertAlmostEqual(one, other, delta=1e-15)

    async def test_wrong_inputs_are_rejected_before_they_are_sent(self) -> None:
        async with await connect(self.socket) as core, await core.open_session("test") as session:
            goal = await session.load(ECHO)
            with self.assertRaisesRegex(ValueError, "there is no input gian; there are: goal, gain"):
                await goal.set(gian=1.0)
            with self.assertRaisesRegex(ValueError, "joints: 3 elements are needed"):
                await goal.set(gain=1.0, joints=[1.0])
            # Nothing was set, also not what was right.
            with self.assertRaises(RpiError):
                await goal.start()

    @needs("numpy")
    async def test_arrays_of_numpy_are_inputs(self) -> None:
        import numpy as np

        async with await connect(self.socket) as core, await core.open_session("test") as session:
            goal = await session.load(ECHO)
            parts = [{"mass": np.float64(1), "count": np.int64(2)}] * 2
            await goal.set(goal=Pose(Vector(*np.arange(3.0))), gain=np.float32(0.5), mode=np.int8(1), joints=np.arange(3), parts=parts, on=np.True_)
            await goal.start()
            values = (await goal.result()).values
            self.assertEqual((values["joints_out"], values["mode_out"], values["sometimes"]), ([0.0, 1.0, 2.0], 1, 0.5))

    async def test_the_end_of_a_block_ends_sessions_and_goals(self) -> None:
        endless = "command Endless () let finish stopped when cancel; finish never when false; tel"
        async with await connect(self.socket) as core:
            async with await core.open_session("outer", on_loss=OnLoss.RUN_ON) as session:
                async with await session.load(endless) as goal:
                    await goal.start()
                    while goal.latest.state is not State.RUNNING:
                        await asyncio.sleep(0.01)
                self.assertEqual((await goal.result()).result, "stopped")
                with self.assertRaises(RpiError):
                    await core.call("command.describe", command=goal.name)
                async with await session.load(endless) as ready:
                    pass
                with self.assertRaises(RpiError):
                    await core.call("command.describe", command=ready.name)
                running = await session.load(endless)
                await running.start()
            ending = await asyncio.wait_for(running.result(), 10)
            self.assertIs(ending.cause, Cause.ABORTED)
            async with await core.open_session("closed") as session:
                first = await session.load(endless)
                async with await session.load(endless) as second:
                    await second.follow(first)
                async with await session.load(endless) as third:
                    await third.unload()
                await session.close()
            with self.assertRaisesRegex(KeyError, "of the block"):
                async with await core.open_session("broken"):
                    await core.close()
                    raise KeyError("of the block")

    async def test_feedback_is_a_table(self) -> None:
        text = "command Count () let n = 1 -> pre n + 1; late = n > 50; x = real(n) when late; export n; export x; finish done when n >= 100; tel"
        async with await connect(self.socket) as core, await core.open_session("test") as session:
            goal = await session.load(text, feedback_period=0.005)
            rows = asyncio.create_task(goal.table())
            await asyncio.sleep(0)
            await goal.start()
            table = await asyncio.wait_for(rows, 10)
            self.assertEqual((table.name, table.columns), ("Count", ("n", "x")))
            self.assertEqual((table["n"][-1], table["x"][-1], table["x"][0]), (100, 100.0, None))
            self.assertEqual(table["n"], sorted(table["n"]))
            self.assertEqual(table.times, sorted(table.times))
            self.assertIn("<b>Count</b> (terminated)", goal._repr_html_())

    async def test_an_arm_moves(self) -> None:
        async with await connect(self.socket) as core, await core.open_session("test") as session:
            arm = (await session.devices())["arm"]
            assert isinstance(arm, Arm)
            self.assertEqual((arm.kind, arm.joint_count), ("arm", 6))
            async with await arm.watch("pose", "commanded", feedback_period=0.0) as watched:
                await self.first_values(watched.feedback())
                start = watched.latest.values["pose"]
                position = start.position._replace(y=start.position.y + 0.02)
                goal = await arm.line(Pose(position, start.orientation), speed=0.5, acceleration=2.0, jerk=50.0)
                await goal.start()
                ending = await asyncio.wait_for(goal.result(), 20)
                self.assertEqual((ending.result, ending.values["progress"]), ("at_goal", 1.0))
                await asyncio.sleep(0.1)
                end = watched.latest.values["pose"]
                for one, other in zip(end.position, position):
                    self.assertAlmostEqual(one, other, delta=1e-6)
                joints = watched.latest.values["commanded"]
                target = [joint + 0.05 for joint in joints]
                goal = await arm.point_to_point(target, speed=2.0, acceleration=10.0, jerk=100.0)
                await goal.start()
                self.assertEqual((await asyncio.wait_for(goal.result(), 20)).result, "at_goal")
            for joint, expected in zip((await watched.result()).values["commanded"], target):
                self.assertAlmostEqual(joint, expected, delta=1e-9)
            for bound in (0.0, -1.0, float("nan"), float("inf")):
                with self.assertRaisesRegex(ValueError, "not a positive number"):
                    await arm.line(start, speed=bound)
            with self.assertRaisesRegex(ValueError, "to: 6 elements are needed"):
                await arm.point_to_point([0.0] * 7)

    async def test_a_gripper_and_a_sensor(self) -> None:
        async with await connect(self.socket) as core, await core.open_session("test") as session:
            devices = await session.devices()
            hand, barrier = devices["hand"], devices["barrier"]
            assert isinstance(hand, Gripper)
            self.assertIs(type(barrier), Device)
            for width, result in ((0.08, "at_width"), (0.0, "holding")):
                goal = await hand.move(width)
                await goal.start()
                ending = await asyncio.wait_for(goal.result(), 20)
                self.assertEqual(ending.result, result)
            self.assertEqual((ending.values["opening"], ending.values["force"]), (0.03, 20.0))
            watched = await barrier.watch("interrupted")
            self.assertEqual(await self.first_values(watched.feedback()), {"interrupted": False})
            with self.assertRaisesRegex(RpiError, "has no `opening`"):
                await barrier.watch("opening")
            with self.assertRaisesRegex(ValueError, "not a name"):
                await barrier.watch("interrupted; finish never when false")

    async def first_values(self, updates: AsyncIterator[Feedback]) -> dict[str, Any]:
        """Returns the first values of a command."""
        async for feedback in updates:
            if feedback.values:
                return feedback.values
        self.fail("the command has ended without values")


if __name__ == "__main__":
    unittest.main()
