"""The robot with the shape of LeRobot's: against a server, and against the class of that package if it is installed."""

from __future__ import annotations

import importlib
import importlib.util
import inspect
import math
import sys
import time
import unittest
from typing import Any

from rpi_client.lerobot import RpiRobot, RpiRobotConfig

from support import CellTest, needs, needs_rpi

#: The documented members of LeRobot's class `Robot`, with the parameters of its methods.
SHAPE = {
    "connect": ["self", "calibrate"],
    "calibrate": ["self"],
    "configure": ["self"],
    "get_observation": ["self"],
    "send_action": ["self", "action"],
    "disconnect": ["self"],
    "is_connected": None,
    "is_calibrated": None,
    "observation_features": None,
    "action_features": None,
}


class StillCamera:
    """A camera with the shape of LeRobot's."""

    height, width = 2, 3
    is_connected = False

    def connect(self) -> None:
        self.is_connected = True

    def disconnect(self) -> None:
        self.is_connected = False

    def async_read(self) -> Any:
        return [[[0, 0, 0]] * 3] * 2


class ShapeTest(unittest.TestCase):
    def test_it_has_the_documented_members(self) -> None:
        self.compare(SHAPE)

    def test_it_has_the_members_of_the_installed_package(self) -> None:
        if importlib.util.find_spec("lerobot") is None:
            print("\nSKIPPED: the package lerobot is not installed: its class Robot is NOT compared", file=sys.stderr)
            self.skipTest("without lerobot")
        base: Any = importlib.import_module("lerobot.robots").Robot
        members = {name: getattr(base, name) for name in base.__abstractmethods__}
        self.compare({name: None if isinstance(member, property) else parameters(member) for name, member in members.items()})

    def compare(self, shape: dict[str, list[str] | None]) -> None:
        for name, wanted in shape.items():
            member = inspect.getattr_static(RpiRobot, name)
            self.assertEqual(None if isinstance(member, property) else parameters(member), wanted, name)


def parameters(method: Any) -> list[str]:
    """Returns the names of the parameters of a method."""
    return list(inspect.signature(method).parameters)


@needs_rpi
class RobotTest(CellTest):
    def setUp(self) -> None:
        super().setUp()
        self.serve()

    def robot(self, **options: Any) -> RpiRobot:
        return RpiRobot(RpiRobotConfig(self.socket, id="test", **options))

    def test_features_are_known_without_a_connection(self) -> None:
        robot = self.robot(gripper="hand", cameras={"front": StillCamera()})
        self.assertEqual(list(robot.action_features), [*(f"joint_{k}.pos" for k in range(1, 7)), "gripper.pos"])
        self.assertEqual({**robot.action_features, "front": (2, 3, 3)}, robot.observation_features)
        self.assertEqual((robot.is_connected, robot.is_calibrated, str(robot)), (False, True, "test RpiRobot"))
        for call in (robot.get_observation, robot.disconnect, lambda: robot.send_action({})):
            with self.assertRaisesRegex(ConnectionError, "is not connected"):
                call()

    def test_actions_move_the_arm_and_the_gripper(self) -> None:
        camera = StillCamera()
        with self.robot(gripper="hand", cameras={"front": camera}, fps=50.0) as robot:
            with self.assertRaisesRegex(ConnectionError, "connected already"):
                robot.connect()
            first = robot.get_observation()
            self.assertEqual(set(first), set(robot.observation_features))
            names = [name for name in robot.action_features if name != "gripper.pos"]
            for step in range(1, 26):
                action = {name: first[name] + 0.004 * step for name in names}
                self.assertEqual(robot.send_action({**action, "gripper.pos": 0.06}), {**action, "gripper.pos": 0.06})
                time.sleep(0.02)
            time.sleep(0.8)
            last = robot.get_observation()
            for name in names:
                self.assertAlmostEqual(last[name], first[name] + 0.1, delta=1e-3)
            self.assertAlmostEqual(last["gripper.pos"], 0.06, delta=1e-3)
            far = robot.send_action({**action, names[0]: 1e6, "gripper.pos": 0.06})
            self.assertLess(far[names[0]], 7.0)
            with self.assertRaises(KeyError):
                robot.send_action({names[0]: 0.0})
            with self.assertRaisesRegex(ValueError, "not a finite number"):
                robot.send_action({**action, names[0]: math.nan})
            self.assertTrue(camera.is_connected)
        self.assertEqual((robot.is_connected, camera.is_connected), (False, False))
        # The arm is free again.
        with self.robot() as robot:
            self.assertTrue(robot.is_connected)

    def test_a_wrong_cell_is_an_error(self) -> None:
        with self.assertRaisesRegex(ValueError, "no arm arm with 7 axes; there are: <Arm arm: arm>"):
            self.robot(joints=7).connect()
        with self.assertRaises(OSError):
            RpiRobot(RpiRobotConfig(str(self.folder / "none.sock"))).connect()

    @needs("pyarrow")
    def test_frames_of_actions(self) -> None:
        file = self.folder / "frames.parquet"
        with self.robot(frames=file) as robot:
            for _ in range(3):
                seen = robot.get_observation()
                robot.send_action(seen)
        rows = importlib.import_module("pyarrow.parquet").read_table(file).to_pylist()
        self.assertEqual([row["frame_index"] for row in rows], [0, 1, 2])
        self.assertEqual(rows[2]["observation.state"], list(seen.values()))
        self.assertEqual(rows[2]["action"], list(seen.values()))


if __name__ == "__main__":
    unittest.main()
