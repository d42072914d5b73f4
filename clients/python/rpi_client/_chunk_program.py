"""The program that follows the chunks of a policy."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from ._chunk import LEAST_ROWS, MOST_ROWS
from ._terminals import terminal_of, terminals_of, type_with_terminals
from ._text import identifier, real_text

#: Sensors of the arm that every observation has.
_SENSORS = ("position", "velocity", "commanded", "measured")

#: Outputs of the motion that the command exports, with their conversion to plain numbers.
_OUTPUTS = (
    ("accepted", ""),
    ("row", ""),
    ("deviation", " / 1[rad]"),
    ("smoothed", " / 1[rad]"),
    ("lag", " / 1[s]"),
    ("remaining", " / 1[s]"),
    ("late", ""),
    ("axis", ""),
    ("limit", ""),
)

#: Flows of the command beside these outputs.
_COUNTS = (
    "clock", "seen", "taken", "accepted_count", "rejected", "rejected_count", "late_time", "resting", "most_deviation", "most_smoothed"
)  # fmt: skip


@dataclass(frozen=True)
class ChunkOptions:
    """How an arm follows the chunks of a policy.

    ``rows`` is the largest number of rows of a chunk (4 to 200), ``period`` the time between two of them (0.01 to 0.1 s). ``previous`` is the
    weight of the chunk before where two overlap (0 to 0.95), ``smoothing`` the largest deviation by smoothing at a row (rad). ``speed``
    (rad/s), ``acceleration`` (rad/s^2) and ``jerk`` (rad/s^3) bound each joint beside its own limits. ``velocities`` states that chunks
    have velocities. With ``poses`` the rows are poses of the tool. ``gripper`` names a gripper of the cell whose opening belongs to the chunks.
    ``channels`` names other actuators whose values belong to them, with their units: ``{"spindle.speed": "rad/s"}``; an empty unit is a plain
    number, ``"bool"`` a truth value, true from 0.5 on. An output of a digital or analogue device has an index, as in ``{"torch.set[0]": "bool"}``; all
    outputs before it must be named, too. Before the first chunk, outputs keep their values and other actuators are 0. ``off_at_rest`` names those truth
    values among them that are false while the arm rests, because the next chunk is late or the operator pauses: a torch, but no vacuum gripper. ``observe`` names further sensors for the observations:
    ``"force"`` of the arm, ``"hand.opening"`` of another device, which has the name ``hand_opening`` in the values, or ``"torch.get[0]"``."""

    rows: int = 50
    period: float = 0.02
    previous: float = 0.0
    smoothing: float = 0.01
    speed: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    velocities: bool = False
    poses: bool = False
    gripper: str | None = None
    channels: Mapping[str, str] = field(default_factory=dict)
    observe: Sequence[str] = ()
    off_at_rest: Sequence[str] = ()

    def check(self) -> None:
        """``ValueError`` for a number that is out of its range, and for options that exclude each other."""
        ranges = (
            ("rows", self.rows, LEAST_ROWS, MOST_ROWS),
            ("period", self.period, 0.01, 0.1),
            ("previous", self.previous, 0.0, 0.95),
            ("smoothing", self.smoothing, 0.0, 1.0),
        )
        for name, value, least, most in ranges:
            if not least <= value <= most:
                raise ValueError(f"{name} is {value}, not from {least} to {most}")
        if self.poses and self.velocities:
            raise ValueError("chunks of poses have no velocities")
        for name in self.off_at_rest:
            if self.channels.get(name) != "bool":
                raise ValueError(f'off_at_rest: {name} is no truth value among the channels; add {name!r}: "bool" to them')


def chunk_program(arm: str, joint_count: int, types: dict[str, tuple[str, str]], options: ChunkOptions) -> str:
    """Returns the text of a command that follows chunks. ``types`` has the module and the type of each device in programs; the type of one of the
    module ``io`` depends on the options.

    The age of a chunk is computed in the cycle that takes it, from ``observed``, a time of the command's own clock: an age computed by
    the client would be wrong by the time that the request takes, which is another one for each chunk."""
    options.check()
    arm = identifier(arm)
    devices = _devices(arm, options)
    for name in devices:
        if name not in types:
            raise ValueError(f"there is no device {name} with a type in programs; there are: {', '.join(types)}")
    uses = sorted({types[name][0] for name in devices} | {"motion"})
    heads = "; ".join(f"{name}: {_type_of(name, types[name], options)}" for name in devices)
    lines = [
        *_inputs(joint_count, options),
        *_motion(arm, joint_count, options),
        *_counters(),
        *([f"arm_moves = {arm}.moving;"] if options.off_at_rest else []),
        *(line for channel in _channels(options) for line in channel.lines()),
        *_outputs(devices, options),
        *_exports(arm, options),
        "finish rests when resting and cancel;",
        # If several results hold in a cycle, that of an error counts.
        "fail stopped when way.stopped and not resting;",
        f"fail arm_error when {arm}.error;",
    ]
    body = "".join(f"  {line}\n" for line in lines)
    return f"use {', '.join(uses)};\n{_UNITS}command FollowPolicy ({heads})\nlet\n{body}tel\n"


_UNITS = (
    "node Radians (x: real) returns (y: real[rad]) let y = x * 1[rad]; tel\n"
    "node RadiansPerSecond (x: real) returns (y: real[rad/s]) let y = x * 1[rad/s]; tel\n"
)


#: Pose of a row that no chunk has set.
_NO_POSE = "pose(0[m], 0[m], 0[m], 0[rad], 0[rad], 0[rad])"


def _devices(arm: str, options: ChunkOptions) -> list[str]:
    """Returns the names of the devices that the command uses, the arm first."""
    names = [arm]
    others = [port.rpartition(".")[0] for port in (*options.channels, *options.observe)]
    for name in [options.gripper or "", *others]:
        if name and name not in names:
            names.append(identifier(name))
    return names


def _type_of(device: str, kind: tuple[str, str], options: ChunkOptions) -> str:
    """Returns the type of a device in the program."""
    module, name = kind
    return type_with_terminals(device, options.channels, options.observe) if module == "io" else name


def _inputs(joint_count: int, options: ChunkOptions) -> list[str]:
    size = joint_count * options.rows
    arrays = [] if options.poses else [("positions", size)]
    if options.velocities:
        arrays.append(("velocities", size))
    arrays += [(channel.key, options.rows) for channel in _channels(options)]
    scalars = (("Int", "number", "0"), ("Int", "count", str(options.rows)), ("Int", "frozen", "0"))
    lines = [
        *(f'{key} = Core::{kind}NetcommIn<<Key: "{key}", Value: {value}>>().outValue;' for kind, key, value in scalars),
        'appended = Core::BooleanNetcommIn<<Key: "append", Value: false>>().outValue;',
        'observed = Core::DoubleNetcommIn<<Key: "observed", Value: 0.0>>().outValue;',
        *(f'{key} = Core::DoubleArrayNetcommIn<<Key: "{key}", Value: 0.0^{length}>>().outValue;' for key, length in arrays),
    ]
    if options.poses:
        lines.append(f'poses = World::FrameArrayNetcommIn<<Key: "poses", Value: {_NO_POSE}^{options.rows}>>().outValue;')
    return lines


def _motion(arm: str, joint_count: int, options: ChunkOptions) -> list[str]:
    size = joint_count * options.rows
    bounds = (("speed", options.speed, "rad/s"), ("acceleration", options.acceleration, "rad/s^2"), ("jerk", options.jerk, "rad/s^3"))
    statics = [f"n: {joint_count}", f"rows: {options.rows}"]
    statics += [f"{name}: {real_text(name, value)}[{unit}]" for name, value, unit in bounds if value is not None]
    arguments = [
        arm,
        "number",
        "poses" if options.poses else f"map<<Radians, {size}>>(positions)",
        f"period: {real_text('period', options.period)}[s]",
        # A time in the future, as by an error of the clocks, counts as now.
        "age: max(time - observed * 1[s], 0[s])",
        "count: count",
        "append: appended",
        "frozen: frozen",
        f"previous: {options.previous!r}",
        f"smoothing: {options.smoothing!r}[rad]",
    ]
    if options.velocities:
        arguments += [f"velocities: map<<RadiansPerSecond, {size}>>(velocities)", "with_velocities: true"]
    fragment = "PoseChunks" if options.poses else "Chunks"
    call = f"{fragment}<<{'; '.join(statics)}>>({', '.join(arguments)})"
    return ["clock = time / 1[s];", f"way = {call};", f"{arm}.joints = way.joints;"]


def _counters() -> list[str]:
    """Counts in the core, because feedback reports values every few cycles only."""
    return [
        "seen = number;",
        "changed = way.accepted <> (0 -> pre accepted);",
        # Chunks of poses are rejected some cycles after they have come.
        "refused = way.rejected <> 0 and (seen <> (0 -> pre seen) or (0 -> pre way.rejected) = 0);",
        "taken = if changed then clock else (0.0 -> pre taken);",
        "accepted_count = (0 -> pre accepted_count) + (if changed then 1 else 0);",
        # The motion forgets the code with the next chunk that it accepts, which may come before the next feedback.
        "rejected = if refused then way.rejected else (0 -> pre rejected);",
        "rejected_count = (0 -> pre rejected_count) + (if refused then 1 else 0);",
        # The arm is not late before it follows its first chunk.
        "began = not way.late or (false -> pre began);",
        "late_time = (0.0 -> pre late_time) + (if way.late and began then clock - (0.0 -> pre clock) else 0.0);",
        "most_deviation = max(way.deviation / 1[rad], 0.0 -> pre most_deviation);",
        "most_smoothed = max(way.smoothed / 1[rad], 0.0 -> pre most_smoothed);",
        # A cancel request pauses the motion, which is not done then; it still rests where it was.
        "resting = way.done or cancel and (false -> pre resting);",
    ]


class _Channel(NamedTuple):
    """Values of an actuator that belong to the rows of chunks."""

    #: Input of the values.
    key: str
    #: Actuator, or a flow that becomes one of several outputs.
    target: str
    #: Value from a plain number.
    value: str
    #: Value before the first chunk.
    first: str

    def lines(self) -> list[str]:
        key = self.key
        return [
            # A chunk that is not accepted must not move anything.
            f"held_{key} = if changed then {key} else ({key} -> pre held_{key});",
            f"first_{key} = {self.first} -> pre first_{key};",
            f"now_{key} = held_{key}[way.row];",
            f"{self.target} = if way.accepted <> 0 then {self.value.format(f'now_{key}')} else first_{key};",
        ]


def _channels(options: ChunkOptions) -> list[_Channel]:
    """Returns the actuators beside the arm. ``ValueError`` for a name or a unit that cannot stand in a program."""
    channels = []
    if options.gripper is not None:
        hand = identifier(options.gripper)
        channels.append(_Channel("widths", f"{hand}.width", "{} * 1[m]", f"{hand}.opening"))
    for name, unit in options.channels.items():
        value, first = _conversion(name, unit)
        if name in options.off_at_rest:
            value = f"{value} and arm_moves"
        terminal = terminal_of(name)
        if terminal is not None:
            first = terminal.present_value(is_digital=unit == "bool")
        channels.append(_Channel(channel_key(name), _target_of(name), value, first))
    return channels


def _target_of(actuator: str) -> str:
    if terminal_of(actuator) is not None:
        return f"driven_{flow_name(actuator)}"
    device, _, port = actuator.rpartition(".")
    return f"{identifier(device)}.{identifier(port)}"


def _outputs(devices: list[str], options: ChunkOptions) -> list[str]:
    """Drives the outputs of digital and analogue devices, all of one device together."""
    lines = []
    for device in devices:
        driven = terminals_of(device, "set", options.channels)
        if driven:
            values = ", ".join(_target_of(f"{device}.set[{index}]") for index in driven)
            lines.append(f"{device}.set = [{values}];")
    return lines


def _conversion(name: str, unit: str) -> tuple[str, str]:
    """Returns the form of a value in this unit, with braces in the place of its number, and the value 0."""
    if unit == "bool":
        return "{} >= 0.5", "false"
    if not unit:
        return "{}", "0.0"
    if not re.fullmatch(r"[A-Za-z0-9*/^]+", unit, re.ASCII):
        raise ValueError(f"{name}: {unit!r} is not a unit of programs")
    return f"{{}} * 1[{unit}]", f"0[{unit}]"


def channel_key(actuator: str) -> str:
    """Returns the name of the input with the values of an actuator: ``channel_spindle_speed`` for ``spindle.speed``."""
    return f"channel_{flow_name(actuator)}"


def _exports(arm: str, options: ChunkOptions) -> list[str]:
    lines = [f"{name} = way.{name}{factor};" for name, factor in _OUTPUTS]
    names = [*_COUNTS, *(name for name, _ in _OUTPUTS)]
    for sensor in (*_SENSORS, *options.observe):
        name = flow_name(sensor)
        if name not in names:
            lines.append(f"{name} = {_sensor_of(arm, sensor)};")
            names.append(name)
    return [*lines, *(f"export {name};" for name in names)]


def _sensor_of(arm: str, sensor: str) -> str:
    terminal = terminal_of(sensor)
    if terminal is not None:
        return f"{terminal.device}.{terminal.port}[{terminal.number}]"
    device, _, port = sensor.rpartition(".")
    return f"{identifier(device) if device else arm}.{identifier(port)}"


def flow_name(sensor: str) -> str:
    """Returns the name of a sensor among the exports: ``hand_opening`` for ``hand.opening``, ``torch_get_0`` for ``torch.get[0]``."""
    return sensor.replace(".", "_").replace("[", "_").replace("]", "")
