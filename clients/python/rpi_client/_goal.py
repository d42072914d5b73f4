"""Commands with the shape of goal, feedback, result, preempt."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, AsyncIterator, Sequence, TypeVar

from ._core import GONE, RpiError

if TYPE_CHECKING:
    from ._core import Core

_Record = TypeVar("_Record", "Ending", "Overruns", "Step")


@dataclass(frozen=True)
class Ending:
    """How a command has ended: ``cause`` (``result``, ``fault``, ``aborted``, ...), the name of its result, its error number
    (0 for none), the number of its cycles, whether it had been cancelled, whether it left something moving, whether another took over;
    ``why`` it ended so, in which ``place`` of the program and ``at`` which line and column of the text (``3:21``), where that was not its own doing;
    the devices that ``braked`` on their own; by how much its first set-points did not join those of whoever went before
    (``jump``: which actuator and quantity, value and limit), where they did not."""

    cause: str
    result: str | None
    error: int
    cycles: int
    cancelled: bool
    left_moving: bool
    taken_over: bool = False
    why: str | None = None
    place: str | None = None
    at: str | None = None
    braked: list[str] = field(default_factory=list)
    jump: str | None = None


@dataclass(frozen=True)
class Overruns:
    """Ticks of the server that ended too late and in which a command took the longest: how many; of the worst how long the command
    ``took`` and by how much the tick was ``late`` (s), and the ``fragment`` that was at work, empty for the command itself."""

    count: int = 0
    took: float = 0.0
    late: float = 0.0
    fragment: str = ""


def _as(kind: type[_Record], update: dict[str, Any]) -> _Record:
    """Reads a record from an update of the server. Unknown keys, which a newer server may send, are ignored."""
    known = {entry.name for entry in fields(kind)}
    return kind(**{key: value for key, value in update.items() if key in known})


@dataclass(frozen=True)
class Feedback:
    """What a command exports, as texts that keep every bit, where it is in its life, and whether it jumped, as in :class:`Ending`."""

    state: str
    values: dict[str, str] = field(default_factory=dict)
    jump: str | None = None


class Session:
    """Owns commands. When the connection ends, its policy says what becomes of them."""

    def __init__(self, core: Core, name: str) -> None:
        self._core = core
        self.name = name

    async def load(
        self,
        text: str,
        *,
        command: str | None = None,
        language: str = "rpi",
        period: float = 0.0,
        feedback_period: float = 0.02,
        on_overrun: str | None = None,
    ) -> Goal:
        """Loads a command of a program (``language="rpi"``) or a net (``"rpinet"``); periods in s, 0 for the server's tick.

        ``on_overrun`` is what becomes of it if its cycles take too long: ``"count"``, ``"abort:N/M"`` (it ends at the Nth of M
        cycles) or ``"stop:N/M"`` (everything does); the default of the server unless given.
        """
        params: dict[str, Any] = {"session": self.name, "text": text, "language": language, "period": period}
        if command is not None:
            params["command"] = command
        if on_overrun is not None:
            params["on_overrun"] = on_overrun
        loaded = await self._core.call("command.load", **params)
        goal = Goal(self._core, loaded["command"])
        await self._core.call("watch.command", command=goal.name, period=feedback_period)
        return goal

    async def load_task(
        self, text: str, *, task: str | None = None, period: float = 0.0, on_overrun: str | None = None
    ) -> Task:
        """Loads a task of a program, which the server carries out; the period in s, 0 for the server's tick; ``on_overrun`` as for
        :meth:`load`, for each of its commands."""
        params: dict[str, Any] = {"session": self.name, "text": text, "period": period}
        if task is not None:
            params["task"] = task
        if on_overrun is not None:
            params["on_overrun"] = on_overrun
        loaded = await self._core.call("task.load", **params)
        made = Task(self._core, loaded["task"])
        await self._core.call("watch.task", task=made.name)
        return made

    async def rule(
        self, when: str, *, stop: Sequence[Goal] = (), cancel: Sequence[Goal] = (), start: Sequence[Goal] = ()
    ) -> str:
        """Makes a rule: when this condition holds, these are stopped, cancelled and started between the same two cycles."""
        names = {key: [goal.name for goal in goals] for key, goals in (("stop", stop), ("cancel", cancel), ("start", start))}
        made = await self._core.call("rule.make", when=when, **names)
        return str(made["rule"])

    async def withdraw(self, rule: str) -> None:
        """Withdraws the rule with this name; :class:`RpiError` if it is unknown or has fired."""
        await self._core.call("rule.withdraw", rule=rule)

    async def close(self) -> None:
        """Ends all its commands by force."""
        await self._core.call("session.close", session=self.name)


class Goal:
    """A loaded command."""

    def __init__(self, core: Core, name: str) -> None:
        self._core = core
        self.name = name
        self._readers: list[asyncio.Queue[Feedback | None]] = []
        self._ending: asyncio.Future[Ending] = asyncio.get_running_loop().create_future()
        self._latest = Feedback("ready")
        core.listen(name, self._hear)

    async def start(self) -> None:
        """Starts it: all that it needs is free, or :class:`RpiError`."""
        await self._core.call("command.start", command=self.name)

    async def follow(self, after: Goal, results: list[str] | None = None) -> str:
        """Lets it run in the cycle after the last one of ``after``: by any regular end, or by these results."""
        made = await self._core.call("command.schedule", command=self.name, after=after.name, results=results or [])
        return str(made["rule"])

    async def set(self, **values: float | int | bool | str) -> None:
        """Sets inputs, all between the same two cycles."""
        await self._core.call("command.set", command=self.name, values=values)

    async def preempt(self, grace: float | None = None) -> Ending:
        """Cancels it and waits until it has ended: on its path, or by an abort when it has not ended within ``grace`` seconds
        (by default those of the session). The devices are free then."""
        await self._core.call("command.cancel", command=self.name, grace=grace)
        return await self.result()

    async def abort(self) -> None:
        """Ends it at once; devices stop on their own limits."""
        await self._core.call("command.abort", command=self.name)

    async def overruns(self) -> Overruns:
        """Its cycles that took too long."""
        described = await self._core.call("command.describe", command=self.name)
        overruns = described.get("overruns", {})
        return _as(Overruns, {key: value for key, value in overruns.items() if value is not None})

    async def unload(self) -> None:
        """Lets go of it."""
        await self._core.call("command.unload", command=self.name)

    async def feedback(self) -> AsyncIterator[Feedback]:
        """Yields the current state, and then each update until the command has ended; after the end, the last update."""
        news: asyncio.Queue[Feedback | None] = asyncio.Queue()
        news.put_nowait(self._latest)
        if self._ending.done():
            news.put_nowait(None)
        self._readers.append(news)
        try:
            while (update := await news.get()) is not None:
                yield update
        finally:
            self._readers.remove(news)

    async def result(self) -> Ending:
        """Waits for its end; :class:`RpiError` if it is unloaded without having run, as who loses a choice is."""
        return await asyncio.shield(self._ending)

    def _hear(self, update: dict[str, Any]) -> None:
        if update.get("gone"):
            self._fail(ConnectionError(GONE))
            return
        state, jump = update.get("state", self._latest.state), update.get("jump", self._latest.jump)
        self._latest = Feedback(state, {**self._latest.values, **update.get("values", {})}, jump)
        self._tell(self._latest)
        if "ending" in update and not self._ending.done():
            self._ending.set_result(_as(Ending, update["ending"]))
            self._tell(None)
        elif state == "unloaded":
            self._fail(_unloaded())

    def _tell(self, news: Feedback | None) -> None:
        for reader in self._readers:
            reader.put_nowait(news)

    def _fail(self, why: Exception) -> None:
        """It will not end any more, unless it has."""
        _fail(self._ending, why)
        self._tell(None)


def _fail(future: asyncio.Future[Any], why: Exception) -> None:
    """Whoever waits for this learns that it will not come."""
    if not future.done():
        future.set_exception(why)
        # Nobody may be waiting for it; that is no fault.
        future.exception()


def _unloaded() -> RpiError:
    return RpiError(-32001, "it was unloaded before it ran", [])


@dataclass(frozen=True)
class Step:
    """How a ``command`` of a task has ended, as in :class:`Ending`; ``handled`` if a branch of the task handles its error."""

    command: str
    cause: str
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
    """How a task has ended: ``state`` (``done``, ``failed``, ``cancelled``), the ``start_error`` with the commands that could not be started and
    the reason, and its latest ended commands."""

    state: str
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
            _fail(self._end, ConnectionError(GONE))
        elif state == "unloaded":
            _fail(self._end, _unloaded())
        elif state in ("done", "failed", "cancelled") and not self._end.done():
            steps = [_as(Step, step) for step in update["ended"]]
            self._end.set_result(TaskEnd(state, update.get("trouble"), steps))
