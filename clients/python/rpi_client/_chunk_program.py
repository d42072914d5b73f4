"""The program that follows the chunks of a policy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ._chunk import LEAST_ROWS, MOST_ROWS
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
_COUNTS = ("clock", "seen", "taken", "accepted_count", "rejected", "rejected_count", "late_time", "resting")


@dataclass(frozen=True)
class ChunkOptions:
    """How an arm follows the chunks of a policy.

    ``rows`` is the largest number of rows of a chunk (4 to 200), ``period`` the time between two of them (0.01 to 0.1 s). ``previous`` is the
    weight of the chunk before where two overlap (0 to 0.95), ``smoothing`` the largest deviation by smoothing at a row (rad). ``speed``
    (rad/s), ``acceleration`` (rad/s^2) and ``jerk`` (rad/s^3) bound each joint beside its own limits. ``velocities`` states that chunks
    have velocities. ``gripper`` names a gripper of the cell whose opening belongs to the chunks. ``observe`` names further sensors for the
    observations: ``"force"`` of the arm, ``"hand.opening"`` of another device, which has the name ``hand_opening`` in the values."""

    rows: int = 50
    period: float = 0.02
    previous: float = 0.0
    smoothing: float = 0.01
    speed: float | None = None
    acceleration: float | None = None
    jerk: float | None = None
    velocities: bool = False
    gripper: str | None = None
    observe: Sequence[str] = ()

    def check(self) -> None:
        """``ValueError`` for a number that is out of its range."""
        ranges = (
            ("rows", self.rows, LEAST_ROWS, MOST_ROWS),
            ("period", self.period, 0.01, 0.1),
            ("previous", self.previous, 0.0, 0.95),
            ("smoothing", self.smoothing, 0.0, 1.0),
        )
        for name, value, least, most in ranges:
            if not least <= value <= most:
                raise ValueError(f"{name} is {value}, not from {least} to {most}")


def chunk_program(arm: str, joint_count: int, types: dict[str, tuple[str, str]], options: ChunkOptions) -> str:
    """Returns the text of a command that follows chunks. ``types`` has the module and the type of each device in programs.

    The age of a chunk is computed in the cycle that takes it, from ``observed``, a time of the command's own clock: an age computed by
    the client would be wrong by the time that the request takes, which is another one for each chunk."""
    options.check()
    arm = identifier(arm)
    devices = _devices(arm, options)
    for name in devices:
        if name not in types:
            raise ValueError(f"there is no device {name} with a type in programs; there are: {', '.join(types)}")
    uses = sorted({types[name][0] for name in devices} | {"motion"})
    heads = "; ".join(f"{name}: {types[name][1]}" for name in devices)
    lines = [
        *_inputs(joint_count, options),
        *_motion(arm, joint_count, options),
        *_counters(),
        *_gripper(options),
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


def _devices(arm: str, options: ChunkOptions) -> list[str]:
    """Returns the names of the devices that the command uses, the arm first."""
    names = [arm]
    others = [sensor.rpartition(".")[0] for sensor in options.observe]
    for name in [options.gripper or "", *others]:
        if name and name not in names:
            names.append(identifier(name))
    return names


def _inputs(joint_count: int, options: ChunkOptions) -> list[str]:
    size = joint_count * options.rows
    arrays = [("positions", size)]
    if options.velocities:
        arrays.append(("velocities", size))
    if options.gripper is not None:
        arrays.append(("widths", options.rows))
    scalars = (("Int", "number", "0"), ("Int", "count", str(options.rows)), ("Int", "frozen", "0"))
    return [
        *(f'{key} = Core::{kind}NetcommIn<<Key: "{key}", Value: {value}>>().outValue;' for kind, key, value in scalars),
        'appended = Core::BooleanNetcommIn<<Key: "append", Value: false>>().outValue;',
        'observed = Core::DoubleNetcommIn<<Key: "observed", Value: 0.0>>().outValue;',
        *(f'{key} = Core::DoubleArrayNetcommIn<<Key: "{key}", Value: 0.0^{length}>>().outValue;' for key, length in arrays),
    ]


def _motion(arm: str, joint_count: int, options: ChunkOptions) -> list[str]:
    size = joint_count * options.rows
    bounds = (("speed", options.speed, "rad/s"), ("acceleration", options.acceleration, "rad/s^2"), ("jerk", options.jerk, "rad/s^3"))
    statics = [f"n: {joint_count}", f"rows: {options.rows}"]
    statics += [f"{name}: {real_text(name, value)}[{unit}]" for name, value, unit in bounds if value is not None]
    arguments = [
        arm,
        "number",
        f"map<<Radians, {size}>>(positions)",
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
    call = f"Chunks<<{'; '.join(statics)}>>({', '.join(arguments)})"
    return ["clock = time / 1[s];", f"way = {call};", f"{arm}.joints = way.joints;"]


def _counters() -> list[str]:
    """Counts in the core, because feedback reports values every few cycles only."""
    return [
        "seen = number;",
        "changed = way.accepted <> (0 -> pre accepted);",
        "refused = seen <> (0 -> pre seen) and way.accepted <> seen;",
        "taken = if changed then clock else (0.0 -> pre taken);",
        "accepted_count = (0 -> pre accepted_count) + (if changed then 1 else 0);",
        # The motion forgets the code with the next chunk that it accepts, which may come before the next feedback.
        "rejected = if refused then way.rejected else (0 -> pre rejected);",
        "rejected_count = (0 -> pre rejected_count) + (if refused then 1 else 0);",
        # The arm is not late before it follows its first chunk.
        "began = not way.late or (false -> pre began);",
        "late_time = (0.0 -> pre late_time) + (if way.late and began then clock - (0.0 -> pre clock) else 0.0);",
        # A cancel request pauses the motion, which is not done then; it still rests where it was.
        "resting = way.done or cancel and (false -> pre resting);",
    ]


def _gripper(options: ChunkOptions) -> list[str]:
    if options.gripper is None:
        return []
    hand = options.gripper
    return [
        # A chunk that is not accepted must not move the fingers.
        "held_widths = if changed then widths else (widths -> pre held_widths);",
        f"first_width = {hand}.opening -> pre first_width;",
        f"{hand}.width = if way.accepted <> 0 then held_widths[way.row] * 1[m] else first_width;",
    ]


def _exports(arm: str, options: ChunkOptions) -> list[str]:
    lines = [f"{name} = way.{name}{factor};" for name, factor in _OUTPUTS]
    names = [*_COUNTS, *(name for name, _ in _OUTPUTS)]
    for sensor in (*_SENSORS, *options.observe):
        device, _, port = sensor.rpartition(".")
        name = flow_name(sensor)
        if name not in names:
            lines.append(f"{name} = {identifier(device) if device else arm}.{identifier(port)};")
            names.append(name)
    return [*lines, *(f"export {name};" for name in names)]


def flow_name(sensor: str) -> str:
    """Returns the name of a sensor among the exports: ``hand_opening`` for ``hand.opening``."""
    return sensor.replace(".", "_")
