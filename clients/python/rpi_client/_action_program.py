"""The program that follows single actions: joint positions that arrive at an even rate."""

from __future__ import annotations

from ._text import identifier, real_text


def action_program(
    arm: str, joint_count: int, gripper: str | None, period: float, bounds: dict[str, tuple[float, str]]
) -> str:
    """Returns the text of a command that moves an arm and a gripper to the newest action. ``bounds`` has the bounds of the motion with their units.

    The joints move to an action within one ``period`` (s) at an even velocity, and rest there if no other action comes: jumps
    from action to action would make them start and stop at each one. The motion never passes an action that was not sent."""
    arm = identifier(arm)
    statics = [f"n: {joint_count}", *(f"{name}: {real_text(name, value)}[{unit}]" for name, (value, unit) in bounds.items())]
    lines = [
        'number = Core::IntNetcommIn<<Key: "number", Value: 0>>().outValue;',
        f'target = Core::DoubleArrayNetcommIn<<Key: "target", Value: 0.0^{joint_count}>>().outValue;',
        "began = number <> 0;",
        "is_new = number <> (0 -> pre number);",
        f"to = if began then map<<Radians, {joint_count}>>(target) else ({arm}.commanded -> pre to);",
        # Where the goal is when an action comes, also on the way to the one before.
        f"start = if is_new then ({arm}.commanded -> pre goal) else ({arm}.commanded -> pre start);",
        "since = if is_new then 0[s] else (0[s] -> pre since + (time - pre time));",
        f"share = min(since / {real_text('period', period)}[s], 1.0);",
        f"goal = map<<Between, {joint_count}>>(start, to, share^{joint_count});",
        f"away = map<<Rate, {joint_count}>>(start, to, (if share < 1.0 then 1.0 / {real_text('period', period)}[s] else 0[1/s])^{joint_count});",
        f"way = Follow<<{'; '.join(statics)}>>({arm}, goal, away);",
        f"{arm}.joints = way.joints;",
        f"position = {arm}.position;",
        f"lower = {arm}.limits.lower;",
        f"upper = {arm}.limits.upper;",
        "export position; export lower; export upper;",
        *_gripper(gripper),
        "finish stopped when way.stopped;",
        f"fail arm_error when {arm}.error;",
    ]
    devices = f"{arm}: Arm<<{joint_count}>>" + ("" if gripper is None else f"; {gripper}: Gripper")
    uses = "use motion;\n" if gripper is None else "use devices, motion;\n"
    body = "".join(f"  {line}\n" for line in lines)
    return f"{uses}{_NODES}command FollowActions ({devices})\nlet\n{body}tel\n"


_NODES = (
    "node Radians (x: real) returns (y: real[rad]) let y = x * 1[rad]; tel\n"
    "node Between (start, to: real[rad]; share: real) returns (at: real[rad]) let at = start + (to - start) * share; tel\n"
    "node Rate (start, to: real[rad]; rate: real[1/s]) returns (speed: real[rad/s]) let speed = (to - start) * rate; tel\n"
)


def _gripper(gripper: str | None) -> list[str]:
    if gripper is None:
        return []
    hand = identifier(gripper)
    return [
        'width = Core::DoubleNetcommIn<<Key: "width", Value: 0.0>>().outValue;',
        f"first_width = {hand}.opening -> pre first_width;",
        f"{hand}.width = if began then width * 1[m] else first_width;",
        f"opening = {hand}.opening;",
        "export opening;",
    ]
