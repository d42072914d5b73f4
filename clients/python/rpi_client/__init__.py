"""Client of the RPI control core (``rpi serve --socket FILE``), on asyncio and the standard library alone.

    async with await connect("rpi.sock") as core:
        session = await core.open_session("demo", on_loss="cancel")
        goal = await session.load(text, command="Follow")
        await goal.start()
        async for feedback in goal.feedback():
            print(feedback.values)
        ending = await goal.result()
"""

from ._core import Core, DeviceInfo, Identity, RpiError, connect
from ._goal import Ending, Feedback, Goal, Overruns, Session, Step, Task, TaskEnd

__all__ = [
    "Core",
    "DeviceInfo",
    "Ending",
    "Feedback",
    "Goal",
    "Identity",
    "Overruns",
    "RpiError",
    "Session",
    "Step",
    "Task",
    "TaskEnd",
    "connect",
]
