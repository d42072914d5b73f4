"""Values and their texts. Needs no server."""

from __future__ import annotations

import math
import random
import unittest
from enum import Enum, IntEnum
from typing import Any

from rpi_client import FlowType, Pose, Rotation, State, Twist, Vector, Wrench
from rpi_client._ports import Ports


class Mode(IntEnum):
    OFF = 0
    ON = 1


def ports(**types: str) -> Ports:
    return Ports([{"key": key, "type": text} for key, text in types.items()], {})


class LiteralTest(unittest.TestCase):
    def test_texts_of_the_server_become_values(self) -> None:
        pose = "{pos:{x:1.0,y:-2.5E-7,z:3.0},rot:{a:0.0,b:0.0,c:3.141592653589793}}"
        turned = Rotation(1.0, 0.0, 0.0, math.cos(math.pi / 2))
        cases = [
            ("real", "1.0E-5", 1e-5),
            ("real", "-inf", -math.inf),
            ("int", "-9223372036854775808", -(2**63)),
            ("bool", "true", True),
            ("Time", "-1500.000001", -1_500_000_001),
            ("Time", "12", 12_000_000),
            ("Pose", pose, Pose(Vector(1.0, -2.5e-7, 3.0), turned)),
            ("Twist", "{vel:{x:1.0,y:2.0,z:3.0},rot:{x:4.0,y:5.0,z:6.0}}", Twist(Vector(1.0, 2.0, 3.0), Vector(4.0, 5.0, 6.0))),
            ("Wrench", "{force:{x:nan,y:2.0,z:3.0},torque:{x:4.0,y:+inf,z:6.0}}", None),
            ("bool^2", "[true,false]", [True, False]),
            ("real^2^3", "[1.0,2.0,3.0,4.0,5.0,6.0]", [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
            ("Vector^1", "[{x:1.0,y:2.0,z:3.0}]", [Vector(1.0, 2.0, 3.0)]),
        ]
        for kind, text, expected in cases:
            with self.subTest(kind=kind, text=text):
                value = FlowType.parse(kind).decode(text)
                if expected is None:
                    assert isinstance(value, Wrench)
                    self.assertTrue(math.isnan(value.force.x))
                    self.assertEqual(value.torque.y, math.inf)
                else:
                    self.assertEqual(value, expected)
                    self.assertIs(type(value), type(expected))

    def test_reals_and_times_keep_every_bit(self) -> None:
        source = random.Random(1)
        real, time = FlowType("real"), FlowType("Time")
        for _ in range(2000):
            value = source.uniform(-1, 1) * 10.0 ** source.randint(-300, 300)
            self.assertEqual(real.decode(real.encode(value)), value)
            instant = source.randint(-(2**62), 2**62)
            self.assertEqual(time.decode(time.encode(instant)), instant)

    def test_rotations_come_back_also_where_two_angles_are_one(self) -> None:
        source = random.Random(2)
        kind = FlowType("Rotation")
        for k in range(3000):
            close = math.pi / 2 * source.choice((-1, 1)) + source.gauss(0, 1) * 10.0 ** source.uniform(-12, -1)
            b = (close, math.pi / 2, source.uniform(-math.pi, math.pi))[k % 3]
            rotation = Rotation.from_euler(source.uniform(-math.pi, math.pi), b, source.uniform(-math.pi, math.pi))
            back = kind.decode(kind.encode(rotation))
            assert isinstance(back, Rotation)
            # A quaternion and its negative are the same rotation.
            sign = math.copysign(1.0, sum(x * y for x, y in zip(rotation, back)))
            for x, y in zip(rotation, back):
                self.assertAlmostEqual(x, sign * y, delta=2e-15)

    def test_matrices_are_those_of_the_angles(self) -> None:
        a, b, c = 0.3, -0.4, 1.2
        rows = Rotation.from_euler(a, b, c).matrix()
        about_z = [[math.cos(a), -math.sin(a), 0.0], [math.sin(a), math.cos(a), 0.0], [0.0, 0.0, 1.0]]
        about_y = [[math.cos(b), 0.0, math.sin(b)], [0.0, 1.0, 0.0], [-math.sin(b), 0.0, math.cos(b)]]
        about_x = [[1.0, 0.0, 0.0], [0.0, math.cos(c), -math.sin(c)], [0.0, math.sin(c), math.cos(c)]]
        for row, expected in zip(rows, product(product(about_z, about_y), about_x)):
            for x, y in zip(row, expected):
                self.assertAlmostEqual(x, y, delta=1e-15)
        self.assertEqual([row[3] for row in Pose.from_euler(1, 2, 3, a, b, c).matrix()], [1, 2, 3, 1])

    def test_wrong_values_are_rejected(self) -> None:
        cases: list[tuple[str, object, type[Exception]]] = [
            ("real", math.nan, ValueError),
            ("real", math.inf, ValueError),
            ("real", "1.0", TypeError),
            ("real", True, TypeError),
            ("int", 1.5, TypeError),
            ("int", True, TypeError),
            ("int", 2**63, ValueError),
            ("bool", 1, TypeError),
            ("real^3", [1.0, 2.0], ValueError),
            ("real^2", "12", TypeError),
            ("Pose", Vector(), TypeError),
            ("Pose", Pose(orientation=Rotation(1.0, 1.0, 0.0, 0.0)), ValueError),
            ("Rotation", (0.0, 0.0, 0.0), ValueError),
            ("Vector", (0.0, math.nan, 0.0), ValueError),
        ]
        for kind, value, error in cases:
            with self.subTest(kind=kind, value=value), self.assertRaises(error):
                FlowType.parse(kind).encode(value)


def product(left: list[list[float]], right: list[list[float]]) -> list[list[float]]:
    """Returns the product of two matrices of 3 by 3."""
    return [[sum(row[k] * right[k][column] for k in range(3)) for column in range(3)] for row in left]


class PortsTest(unittest.TestCase):
    def test_arrays_and_structs_are_split_and_joined(self) -> None:
        rows = ports(**{"k[0]": "real", "k[1]": "real", "rows[0].a": "real", "rows[0].on": "bool", "pose": "Pose"})
        values = {"k": [1.0, 2.0], "rows": [{"a": 3.0, "on": True}], "pose": Pose(Vector(1.0, 2.0, 3.0))}
        texts = rows.encode(values)
        self.assertEqual(texts["rows[0].on"], "true")
        self.assertEqual(rows.nest(rows.decode(texts)), values)
        self.assertEqual(rows.nest(rows.decode({"k[1]": "2.0"})), {"k": [None, 2.0]})
        self.assertEqual(rows.encode({"k[1]": 5}), {"k[1]": "5.0"})

    def test_messages_name_the_part(self) -> None:
        rows = ports(**{"k[0]": "real", "k[1]": "real", "rows[0].a": "real"})
        cases: list[tuple[dict[str, Any], str]] = [
            ({"k": [1.0]}, "k: 2 elements are needed"),
            ({"k": [1.0, "x"]}, r"k\[1\]: 'x' is not of type real"),
            ({"rows": [{"b": 1.0}]}, r"rows\[0\]: there is no field b; there are: a"),
            ({"row": 1.0}, "there is no input row; there are: k, rows"),
        ]
        for values, message in cases:
            with self.subTest(values=values), self.assertRaisesRegex((TypeError, ValueError), message):
                rows.encode(values)

    def test_keys_of_nets_may_contradict_each_other(self) -> None:
        odd = ports(**{"a": "int", "a.b": "int", "c[1]": "int", "d..e": "int", "f[0]": "int", "f.g": "int"})
        values = odd.nest(odd.decode({key: str(k) for k, key in enumerate(odd.types)}))
        self.assertEqual(values, {"a": 0, "a.b": 1, "c": {"1": 2}, "d..e": 3, "f": {"0": 4, "g": 5}})

    def test_flows_inside_a_call_stand_beside_its_result(self) -> None:
        for keys in (["level.inner.y", "level.n[0]", "level"], ["level", "level.n[0]", "level.inner.y"]):
            watched = ports(**dict.fromkeys(keys, "int"))
            values = watched.nest(watched.decode(dict.fromkeys(keys, "1")))
            self.assertEqual(values, dict.fromkeys(keys, 1))
            self.assertEqual([watched.find(key, values) for key in keys], [1, 1, 1])

    def test_parts_of_flows_are_found(self) -> None:
        rows = ports(**{"k[0]": "real", "k[1]": "real", "rows[0].a": "real"})
        values = rows.nest(rows.decode({"k[1]": "2.0", "rows[0].a": "3.0"}))
        found = [rows.find(name, values) for name in ("k", "k[1]", "k[0]", "rows[0].a", "k[7]", "rows.a", "rows[0]")]
        self.assertEqual(found, [[None, 2.0], 2.0, None, 3.0, None, None, {"a": 3.0}])
        self.assertEqual([rows.has(name) for name in ("k", "k[1]", "rows[0]", "ro", "k[2]")], [True, True, True, False, False])

    def test_enums(self) -> None:
        described = [{"key": key, "type": "int"} for key in ("mode", "row[0].mode", "row[1].mode", "count")]
        modes = Ports(described, {"mode": Mode, "row.mode": Mode})
        texts = modes.encode({"mode": Mode.ON, "row": [{"mode": Mode.OFF}, {"mode": 1}], "count": 1})
        self.assertEqual(texts, {"mode": "1", "row[0].mode": "0", "row[1].mode": "1", "count": "1"})
        values = modes.nest(modes.decode({**texts, "count": "7", "row[0].mode": "9"}))
        self.assertEqual(values["row"], [{"mode": 9}, {"mode": Mode.ON}])
        self.assertIs(values["mode"], Mode.ON)
        self.assertNotIsInstance(values["count"], Enum)


class StateTest(unittest.TestCase):
    def test_states_equal_their_words(self) -> None:
        self.assertEqual((State("running"), f"{State.RUNNING}"), ("running", "running"))
        self.assertIs(State("sleeping in a newer server"), State.UNKNOWN)


if __name__ == "__main__":
    unittest.main()
