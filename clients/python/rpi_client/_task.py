"""Tasks, which the server carries out."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ._core import GONE
from ._goal import fail_future, read_record, unloaded_error
from ._states import Cause, TaskState

if TYPE_CHECKING:
    from ._core import Core


@dataclass(frozen=True)
class Step:
    """How a ``command`` of a task has ended, as in :class:`Ending`; ``handled`` if a branch of the task handles its error."""

    command: str
    cause: Cause
    result: str | None
    error: int
    cycles: int
    why: str | None = None
    place: str | None = None
    at: str | None = None
    braked: list[str] = field(default_factory=list)
    jump: str | None = None
    handled: bool = False


@dataclass(frozen=True)
class TaskEnd:
    """How a task has ended: its ``state``, the ``start_error`` with the commands that could not be started and
    the reason, and its latest ended commands."""

    state: TaskState
    start_error: str | None
    steps: list[Step]

    @property
    def commands(self) -> list[tuple[str, str | None]]:
        """Its latest commands with the results by which they ended."""
        return [(step.command, step.result) for step in self.steps]


class Task:
    """A loaded task."""

    def __init__(self, core: Core, name: str) -> None:
        self._core = core
        self.name = name
        self._end: asyncio.Future[TaskEnd] = asyncio.get_running_loop().create_future()
        core.listen(name, self._hear)

    async def start(self) -> None:
        """Starts it."""
        await self._core.call("task.start", task=self.name)

    async def preempt(self) -> TaskEnd:
        """Cancels the task, so that no further command starts and running ones are cancelled, and waits for its end."""
        await self._core.call("task.cancel", task=self.name)
        return await self.result()

    async def unload(self) -> None:
        """Lets go of it: one that runs is unloaded when it has ended."""
        await self._core.call("task.unload", task=self.name)

    async def result(self) -> TaskEnd:
        """Waits for its end; :class:`RpiError` if it is unloaded without having run."""
        return await asyncio.shield(self._end)

    def _hear(self, update: dict[str, Any]) -> None:
        state = update.get("state")
        if update.get("gone"):
            fail_future(self._end, ConnectionError(GONE))
        elif state == "unloaded":
            fail_future(self._end, unloaded_error())
        elif state in (TaskState.DONE, TaskState.FAILED, TaskState.CANCELLED) and not self._end.done():
            steps = [read_record(Step, step) for step in update["ended"]]
            self._end.set_result(TaskEnd(TaskState(state), update.get("trouble"), steps))
