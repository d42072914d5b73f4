"""Recordings as tables, compared with the rows that ``rpi`` itself writes, and their drawings."""

from __future__ import annotations

import csv
import math
import re
import shutil
import struct
import unittest
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from rpi_client import FlowType, Net, Pose, Recording, Svg, Table

from support import CellTest, needs, needs_rpi

PROGRAM = """
use motion;
command Sway (arm: Arm<<6>>)
let
  n = 0 -> pre n + 1;
  late = n >= 20;
  x = sqrt(real(n)) when late;
  way = JointVelocity<<n: 6>>(arm, [0.1[rad/s], 0[rad/s], 0[rad/s], 0[rad/s], 0[rad/s], -0.2[rad/s]]);
  arm.joints = way.joints;
  goal = arm.pose;
  export n; export late; export x; export goal;
  finish done when n >= 40;
tel
command Rest () let finish over when time >= 10[ms]; tel
task Both (arm: Arm<<6>>) let Rest(); Rest(); tel
"""


class TableTest(unittest.TestCase):
    def test_columns_of_nested_values(self) -> None:
        rows: list[tuple[float, dict[str, Any]]] = [(0.0, {"pose": None, "k": [1, 2]}), (1.0, {"pose": {"x": 0.5}, "k": [3]}), (2.5, {"word": "on"})]
        table = Table.from_rows("test", rows)
        self.assertEqual(table.columns, ("k[0]", "k[1]", "pose.x", "word"))
        self.assertEqual((table["k[1]"], table["pose.x"], table["word"]), ([2, None, None], [None, 0.5, None], [None, None, "on"]))
        self.assertEqual([table.kind(column) for column in table.columns], ["int", "int", "real", "other"])
        self.assertEqual(table.select("k").columns, ("k[0]", "k[1]"))
        self.assertEqual(table.between(0.5, 2.5).times, [1.0])
        with self.assertRaisesRegex(KeyError, "there is no j in test"):
            table.select("j")

    def test_texts_of_reals_are_reals_only_beside_reals(self) -> None:
        pairs: list[tuple[Any, Any]] = [(1.0, "inf"), ("nan", "x"), ("-inf", None)]
        table = Table.from_rows("test", [(float(k), {"real": real, "text": text}) for k, (real, text) in enumerate(pairs)])
        self.assertTrue(math.isnan(table["real"][1]))
        self.assertEqual((table["real"][2], table["text"]), (-math.inf, ["inf", "x", None]))

    @needs("numpy", "pandas", "polars")
    def test_absent_values_in_frames(self) -> None:
        import numpy as np

        values: list[dict[str, Any]] = [{"i": 2**62, "b": None, "r": 1.0, "s": "a"}, {"i": None, "b": True, "r": None, "s": None}]
        table = Table.from_rows("test", [(0.5 * k, row) for k, row in enumerate(values)])
        frame = table.to_pandas()
        self.assertEqual([str(kind) for kind in frame.dtypes][:3], ["Int64", "boolean", "float64"])
        self.assertEqual((frame["i"].iloc[0], frame.index.name, frame.index[1]), (2**62, "time", 0.5))
        self.assertEqual([int(frame[column].isna().sum()) for column in frame], [1, 1, 1, 1])
        lazy = table.to_polars()
        self.assertEqual(lazy.rows(), [(0.0, 2**62, None, 1.0, "a"), (0.5, None, True, None, None)])
        arrays = table.to_numpy()
        integers = arrays["i"]
        assert isinstance(integers, np.ma.MaskedArray)
        self.assertEqual((int(integers[0]), np.ma.getmaskarray(integers).tolist()), (2**62, [False, True]))
        self.assertTrue(np.isnan(arrays["r"][1]))
        self.assertEqual(table.array("b").shape, (2,))

    def test_drawings_are_valid_and_small(self) -> None:
        count = 100_000
        wave = [math.sin(k / 50) for k in range(count)]
        wave[70_000:80_000] = [math.nan] * 10_000
        table = Table("a <b> & c", [k / 1000 for k in range(count)], {"x<1>": wave, "on": [k % 2 == 0 for k in range(count)], "word": ["w"] * count})
        curves, shapes = self.curves(table.plot())
        self.assertEqual(len(curves), 2)
        self.assertLess(len(shapes), 200_000)
        self.assertIn("a &lt;b&gt; &amp; c", shapes)
        # A gap begins a new line, and the extremes of the wave are drawn.
        self.assertEqual(curves[0].count("M"), 2)
        heights = [float(point.split()[1]) for point in curves[0].replace("M", "L").split("L")[1:]]
        wide = [float(point.split()[1]) for point in curves[1].replace("M", "L").split("L")[1:]]
        self.assertAlmostEqual((max(heights) - min(heights)) / (max(wide) - min(wide)), 2.0, delta=0.02)

    def test_odd_curves_are_drawn(self) -> None:
        for values in ([], [None], [math.inf], [5.0], [0.0, 0.0], [1e308, -1e308], [5e-324, 0.0], [2**63, 0], [1.0, 1.0 + 2e-16]):
            with self.subTest(values=values):
                times = [float(k) for k in range(len(values))]
                curves, text = self.curves(Table("odd", times, {"x": values}).plot())
                self.assertEqual(len(curves), 1)
                self.assertNotRegex(text, r"\b(nan|inf)\b")

    def test_pages_show_the_ends_of_a_table(self) -> None:
        table = Table("<t>", [float(k) for k in range(100)], {"x": list(range(100))})
        page = table._repr_html_()
        self.assertIn("&lt;t&gt;: 100 rows", page)
        self.assertEqual(page.count("<tr>"), 1 + 5 + 1 + 5)
        self.assertIn("<td>99</td>", page)

    @needs("IPython")
    def test_jupyter_shows_them(self) -> None:
        from IPython.core.formatters import DisplayFormatter

        table = Table("test", [0.0, 1.0], {"x": [1.0, 2.0]})
        cases: list[tuple[object, str, str]] = [
            (table, "text/html", "test: 2 rows"),
            (table.plot(), "image/svg+xml", "<svg"),
            (Net("graph TD", "not a graph"), "text/vnd.mermaid", "graph TD"),
        ]
        formatter: Any = DisplayFormatter()
        formatter.active_types = formatter.format_types
        for shown, kind, text in cases:
            with self.subTest(kind=kind):
                bundle, _ = formatter.format(shown)
                self.assertIn(text, bundle[kind])

    def curves(self, drawing: Svg) -> tuple[list[str], str]:
        """Returns the paths of the curves, and the text of the drawing."""
        text = drawing._repr_svg_()
        root = ElementTree.fromstring(text)
        return [path.get("d", "") for path in root.iter("{http://www.w3.org/2000/svg}path")], text


@needs_rpi
@needs("mcap")
class RecordingTest(CellTest):
    def record(self, *options: str, command: str = "Sway") -> Path:
        """Records a run of the program, and returns the file."""
        self.run_program(PROGRAM, "--command", command, "--record", "out.mcap", *options)
        return self.folder / "out.mcap"

    def rows(self) -> dict[str, dict[int, str]]:
        """Returns what `rpi run` writes as a table: the texts of each flow by cycle."""
        self.run_program(PROGRAM, "--command", "Sway", "--record", "out.csv")
        flows: dict[str, dict[int, str]] = {}
        with (self.folder / "out.csv").open(newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                flows.setdefault(row["flow"], {})[int(row["cycle"])] = row["value"]
        return flows

    def test_values_are_those_of_the_rows(self) -> None:
        recording = Recording(self.record())
        self.assertEqual((recording.cut_off, recording.lost_ticks), (None, 0))
        table, device, rows = recording.table("/command/Sway"), recording.table("/device/arm"), self.rows()
        self.assertEqual((table["n"], table["cycle"]), (list(range(41)), list(range(41))))
        self.assertEqual([round(time * 1000) for time in table.times], table["cycle"])
        self.assertEqual(table["late"], [n >= 20 for n in range(41)])
        self.assertEqual(table["x"], [math.sqrt(n) if n >= 20 else None for n in range(41)])
        self.assertEqual(len(rows), 4 + 6 + 1)
        for flow, texts in rows.items():
            owner, _, name = flow.partition(".")
            own = {"Sway": table, "arm": device}[owner]
            recorded = {cycle: row for row, cycle in enumerate(own["cycle"])}
            shown = [own[column] for column in own.columns if column == name or column.startswith(name + ".")]
            for cycle, text in texts.items():
                values = [column[recorded[cycle]] for column in shown]
                with self.subTest(flow=flow, cycle=cycle):
                    self.compare(values, text)

    def compare(self, values: list[Any], text: str) -> None:
        """Compares the columns of a flow in one cycle with the text of the flow: poses have angles there."""
        if not text.startswith("{"):
            simple = {"": None, "null": None, "true": True, "false": False}
            self.assertEqual(values, [simple[text] if text in simple else float(text)])
            return
        pose = FlowType("Pose").decode(text)
        assert isinstance(pose, Pose)
        self.assertEqual(tuple(values[:3]), pose.position)
        sign = math.copysign(1.0, sum(x * y for x, y in zip(values[3:], pose.orientation)))
        for one, other in zip(values[3:], pose.orientation):
            self.assertAlmostEqual(one, sign * other, delta=2e-15)

    @needs("numpy", "pandas", "polars")
    def test_frames_keep_every_bit(self) -> None:
        table = Recording(self.record()).table("/set_points/arm")
        joints = table.array("joints")
        self.assertEqual(joints.shape, (41, 6))
        frame, lazy = table.to_pandas(), table.to_polars()
        for axis in range(6):
            exact = [struct.pack("<d", value) for value in table[f"joints[{axis}]"]]
            for column in (joints[:, axis], frame[f"joints[{axis}]"], lazy[f"joints[{axis}]"]):
                self.assertEqual([struct.pack("<d", float(value)) for value in column], exact)

    @needs("mcap_ros2")
    def test_ros2_has_the_same_values(self) -> None:
        plain = Recording(self.record())
        tables = {topic: plain.table(topic) for topic in ("/command/Sway", "/device/arm", "/set_points/arm")}
        events = plain.events
        ros = Recording(self.record("--profile", "ros2"))
        for topic, table in tables.items():
            other = ros.table(topic)
            self.assertEqual(table.times, other.times)
            # Fields of ROS have no dots: `joint.position` is `joint_position` there.
            names = [re.sub(r"^(joint|tcp)\.", r"\1_", column) for column in table.columns]
            self.assertEqual(sorted(names), sorted(other.columns))
            for column, name in zip(table.columns, names):
                self.assertEqual(table[column], other[name], column)
        self.assertEqual([(event.kind, event.time) for event in events], [(event.kind, event.time) for event in ros.events])

    def test_events_and_the_time_line(self) -> None:
        recording = Recording(self.record(command="Both"))
        ended = [event for event in recording.events if event.kind == "ended"]
        self.assertEqual([event.details["what"] for event in ended], ["over", "over"])
        starts = [event.time for event in recording.events if event.kind == "started"]
        self.assertEqual([round(time, 3) for time in starts], [0.0, 0.011])
        text = recording.timeline().text
        root = ElementTree.fromstring(text)
        titles = [title.text for title in root.iter("{http://www.w3.org/2000/svg}title")]
        self.assertEqual(len([title for title in titles if title and title.startswith("Rest: over")]), 2)
        self.assertIn("/events", recording._repr_html_())

    def test_parts_are_one_recording(self) -> None:
        file = self.record("--part-time", "15ms")
        parts = sorted(path.name for path in self.folder.glob("out*.mcap"))
        self.assertGreater(len(parts), 2)
        last = self.folder / f"out.{len(parts):04}.mcap"
        recording = Recording(file)
        self.assertEqual((recording.table("/command/Sway")["n"], recording.cut_off), (list(range(41)), None))
        # A file of an earlier recording does not belong to it.
        shutil.copy(last, self.folder / f"out.{len(parts) + 1:04}.mcap")
        self.assertEqual(Recording(file).table("/command/Sway")["n"], list(range(41)))
        (self.folder / "out.0003.mcap").unlink()
        short = Recording(file)
        self.assertEqual(short.cut_off, "a part is missing")
        self.assertEqual(short.table("/command/Sway")["n"], list(range(len(short.table("/command/Sway")))))

    def test_damaged_files_are_read_up_to_the_damage(self) -> None:
        file = self.record()
        whole = file.read_bytes()
        for length in range(0, len(whole), max(1, len(whole) // 40)):
            file.write_bytes(whole[:length])
            cut = Recording(file)
            self.assertIsNotNone(cut.cut_off, length)
            cut._repr_html_()
        for place in range(0, len(whole), max(1, len(whole) // 60)):
            file.write_bytes(whole[:place] + bytes([whole[place] ^ 0x10]) + whole[place + 1 :])
            damaged = Recording(file)
            for topic in ("/command/Sway", "/device/arm"):
                if topic in damaged.topics:
                    self.assertLessEqual(len(damaged.table(topic)), 10_000)

    def test_what_is_not_there_is_named(self) -> None:
        file = self.record()
        with self.assertRaisesRegex(KeyError, "there is no topic /command/Swy"):
            Recording(file).table("/command/Swy")
        with self.assertRaisesRegex(ValueError, "have the encoding rpi-image-1"):
            Recording(file).table("/rpi/images")
        with self.assertRaises(FileNotFoundError):
            Recording(self.folder / "none.mcap")
        program = Recording(file).attachments["program/program.rpi"]
        self.assertEqual(program.decode(), PROGRAM)

    def test_plots_of_flows(self) -> None:
        root = ElementTree.fromstring(Recording(self.record()).plot("/command/Sway", "goal.position", "n").text)
        paths = [path.get("d", "") for path in root.iter("{http://www.w3.org/2000/svg}path")]
        self.assertEqual(len(paths), 4)
        self.assertTrue(all(path.startswith("M") and "L" in path for path in paths))


if __name__ == "__main__":
    unittest.main()
