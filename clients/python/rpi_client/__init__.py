"""Client of the RPI control core (``rpi serve --socket FILE``), on asyncio and the standard library alone.

    async with await connect("rpi.sock") as core, await core.open_session("demo") as session:
        goal = await session.load(text, command="Follow")
        await goal.start()
        async for feedback in goal.feedback():
            print(feedback.values)
        ending = await goal.result()

Recordings need the extra ``mcap``; data frames the extras ``pandas`` or ``polars``, arrays ``numpy``:

    Recording("out.mcap").table("/device/arm").to_pandas()
"""

from ._chunk import Chunk, Limit, Observation
from ._chunk_program import ChunkOptions
from ._chunk_report import ChunkReport, Delays
from ._chunk_stream import ChunkStream
from ._clock import ServerClock
from ._core import Core, DeviceInfo, Identity, RpiError, connect
from ._devices import Arm, Device, Gripper
from ._drawing import Svg
from ._flow_types import FlowType, InputValue, Value
from ._frames import FrameTable
from ._goal import Ending, Feedback, Goal, Overruns, Session
from ._net import Net
from ._policy import Policy
from ._recording import Event, Recording, Topic
from ._states import Cause, OnLoss, State, TaskState
from ._table import Table
from ._task import Step, Task, TaskEnd
from ._values import Pose, Rotation, Twist, Vector, Wrench

__all__ = [
    "Arm",
    "Cause",
    "Chunk",
    "ChunkOptions",
    "ChunkReport",
    "ChunkStream",
    "Core",
    "Delays",
    "Device",
    "DeviceInfo",
    "Ending",
    "Event",
    "Feedback",
    "FlowType",
    "FrameTable",
    "Goal",
    "Gripper",
    "Identity",
    "InputValue",
    "Limit",
    "Net",
    "Observation",
    "OnLoss",
    "Overruns",
    "Policy",
    "Pose",
    "Recording",
    "Rotation",
    "RpiError",
    "ServerClock",
    "Session",
    "State",
    "Step",
    "Svg",
    "Table",
    "Task",
    "TaskEnd",
    "TaskState",
    "Topic",
    "Twist",
    "Value",
    "Vector",
    "Wrench",
    "connect",
]
