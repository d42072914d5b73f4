"""Commands with the shape of goal, feedback, result, preempt."""

from __future__ import annotations

import asyncio
import contextlib
import html
import time
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from types import TracebackType
from typing import TYPE_CHECKING, Any, AsyncIterator, Iterator, Mapping, Sequence, TypeVar

from ._core import GONE, RpiError
from ._devices import Device, make_device
from ._flow_types import FlowType, InputValue, Value
from ._ports import Ports
from ._states import Cause, State
from ._table import Table

if TYPE_CHECKING:
    from ._core import Core
    from ._task import Task

_Record = TypeVar("_Record")


@dataclass(frozen=True)
class Ending:
    """How a command has ended: the ``cause``, the name of its result, its error number
    (0 for none), the number of its cycles, whether it had been cancelled, whether it left something moving, whether another took over;
    ``why`` it ended so, in which ``place`` of the program and ``at`` which line and column of the text (``3:21``), where that was not its own doing;
    the devices that ``braked`` on their own; by how much its first set-points did not join those of whoever went before
    (``jump``: which actuator and quantity, value and limit), where they did not; the last ``values`` of its exports, as in
    :class:`Feedback`."""

    cause: Cause
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
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Overruns:
    """Ticks of the server that ended too late and in which a command took the longest: how many; of the worst how long the command
    ``took`` and by how much the tick was ``late`` (s), and the ``fragment`` that was at work, empty for the command itself."""

    count: int = 0
    took: float = 0.0
    late: float = 0.0
    fragment: str = ""


def read_record(kind: type[_Record], update: dict[str, Any]) -> _Record:
    """Reads a record from an update of the server. Unknown keys, which a newer server may send, are ignored."""
    known = {entry.name for entry in fields(kind)}  # type: ignore[arg-type]
    entries = {key: value for key, value in update.items() if key in known}
    if "cause" in entries:
        entries["cause"] = Cause(entries["cause"])
    return kind(**entries)


@dataclass(frozen=True)
class Feedback:
    """Where a command is in its life, the latest ``values`` of the flows that it exports (each a :data:`Value`), whether it jumped, as in :class:`Ending`, and
    the ``time`` at which this was received, in seconds since the command was loaded.

    A flow that has had no value yet is missing. One that has become absent keeps its latest value, because the server reports new values
    only; a recording has every cycle."""

    state: State
    values: dict[str, Any] = field(default_factory=dict)
    jump: str | None = None
    time: float = 0.0


class Session:
    """Owns commands. When the connection ends, its policy says what becomes of them.

    As a context manager it is closed at the end of the block."""

    def __init__(self, core: Core, name: str) -> None:
        self._core = core
        self.name = name

    async def __aenter__(self) -> Session:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with _gone_already():
            await self.close()

    async def load(
        self,
        text: str,
        *,
        command: str | None = None,
        language: str = "rpi",
        period: float = 0.0,
        feedback_period: float = 0.02,
        on_overrun: str | None = None,
        enums: Mapping[str, type[Enum]] | None = None,
        watch: Sequence[str] = (),
    ) -> Goal:
        """Loads a command of a program (``language="rpi"``) or a net (``"rpinet"``); periods in s, 0 for the server's tick.

        ``enums`` gives the classes for the inputs and exports that are enums in the program, by name (``"part.mode"`` for a field). Their
        members have the numbers of the enum in the program, from 0: an ``IntEnum`` is usual. Without a class, enums are ints.

        ``on_overrun`` is what becomes of it if its cycles take too long: ``"count"``, ``"abort:N/M"`` (it ends at the Nth of M
        cycles) or ``"stop:N/M"`` (everything does); the default of the server unless given.

        ``watch`` names flows whose values the feedback has besides the exports, such as ``"Move.Approach.way.travelled"``: the command,
        the calls and fragments around the flow, and its name. The name of a command, call or fragment stands for all flows inside. At most
        256 names. :meth:`Goal.watch` yields their values.
        """
        params: dict[str, Any] = {"session": self.name, "text": text, "language": language, "period": period, "watch": list(watch)}
        if command is not None:
            params["command"] = command
        if on_overrun is not None:
            params["on_overrun"] = on_overrun
        loaded = await self._core.call("command.load", **params)
        described = await self._core.call("command.describe", command=loaded["command"])
        goal = Goal(self._core, loaded["command"], described, enums or {})
        await self._core.call("watch.command", command=goal.name, period=feedback_period)
        return goal

    async def load_task(
        self,
        text: str,
        *,
        task: str | None = None,
        period: float = 0.0,
        on_overrun: str | None = None,
        watch: Sequence[str] = (),
    ) -> Task:
        """Loads a task of a program, which the server carries out; the period in s, 0 for the server's tick; ``on_overrun`` and
        ``watch`` as for :meth:`load`, for each of its commands."""
        params: dict[str, Any] = {"session": self.name, "text": text, "period": period, "watch": list(watch)}
        if task is not None:
            params["task"] = task
        if on_overrun is not None:
            params["on_overrun"] = on_overrun
        from ._task import Task

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

    async def devices(self) -> dict[str, Device]:
        """Returns the devices of the server's cell by name, as commands of this session use them: an :class:`Arm`, a :class:`Gripper`, or
        a :class:`Device`."""
        return {info.name: make_device(self, info) for info in await self._core.devices()}

    async def close(self) -> None:
        """Ends all its commands by force."""
        await self._core.call("session.close", session=self.name)


class Goal:
    """A loaded command: its ``name`` at the server, its ``title`` in the program, the names of its ``results``.

    As a context manager it is cancelled at the end of the block, if it runs, and unloaded."""

    def __init__(self, core: Core, name: str, described: dict[str, Any], enums: Mapping[str, type[Enum]]) -> None:
        self._core = core
        self.name = name
        self.title: str = described.get("title", name)
        self.results: tuple[str, ...] = tuple(described.get("results", []))
        self._inputs = Ports(described.get("inputs", []), enums)
        self._exports = Ports(described.get("exports", []), enums)
        self._values: dict[str, Value] = {}
        #: Time of ``time.monotonic()`` when it was loaded: that of ``time`` 0 in the feedback.
        self.loaded_at = time.monotonic()
        self._readers: list[asyncio.Queue[Feedback | None]] = []
        self._ending: asyncio.Future[Ending] = asyncio.get_running_loop().create_future()
        self._latest = Feedback(State.READY)
        core.listen(name, self._hear)

    @property
    def inputs(self) -> dict[str, FlowType]:
        """The types of the inputs, by key. An array or struct of a program has a key for each part, such as ``rows[1].mass``."""
        return dict(self._inputs.types)

    @property
    def exports(self) -> dict[str, FlowType]:
        """The types of the exports, by key, as in :attr:`inputs`."""
        return dict(self._exports.types)

    @property
    def units(self) -> dict[str, str]:
        """The units of the inputs and exports that have one, such as ``"m/s"``, by key. Their values are in these units."""
        return {**self._inputs.units, **self._exports.units}

    @property
    def latest(self) -> Feedback:
        """The latest feedback."""
        return self._latest

    async def __aenter__(self) -> Goal:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with _gone_already():
            if self._latest.state in (State.RUNNING, State.CANCELLING):
                await self.preempt()
            if self._latest.state is not State.UNLOADED:
                await self.unload()

    async def start(self) -> None:
        """Starts it: all that it needs is free, or :class:`RpiError`."""
        await self._core.call("command.start", command=self.name)

    async def follow(self, after: Goal, results: list[str] | None = None) -> str:
        """Lets it run in the cycle after the last one of ``after``: by any regular end, or by these results."""
        made = await self._core.call("command.schedule", command=self.name, after=after.name, results=results or [])
        return str(made["rule"])

    async def set(self, **values: InputValue) -> None:
        """Sets inputs, all between the same two cycles: ``set(gain=2.0, goal=Pose(..), joints=[0.0] * 7, part={"mass": 1.5})``.

        ``TypeError`` for a value of another type than its input, ``ValueError`` for an unknown input, for an array of another length and
        for a number that is not finite. Nothing is set then."""
        await self._core.call("command.set", command=self.name, values=self._inputs.encode(values))

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
        return read_record(Overruns, {key: value for key, value in overruns.items() if value is not None})

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

    async def watch(self, flow: str) -> AsyncIterator[Value]:
        """Yields the present value of a flow, and then each new one until the command has ended. ``flow`` is an export, or a flow that was
        named in ``watch`` when the command was loaded, with or without the name of the command before it. ``ValueError`` for any other.

        Updates have the latest value at the end of each feedback period: with a period of several cycles, values between are left out."""
        key = self._flow_key(flow)
        last: Value = None
        async for feedback in self.feedback():
            value = self._exports.find(key, feedback.values)
            if value is not None and value != last:
                last = value
                yield value

    def _flow_key(self, flow: str) -> str:
        """Returns the name of a flow without that of the command."""
        for key in (flow, flow.removeprefix(f"{self.title}.")):
            if self._exports.has(key):
                return key
        raise ValueError(f"{flow} is not watched; name it in `watch` when the command is loaded")

    async def table(self) -> Table:
        """Waits for its end, and returns all feedback from now on as a table: a row for each update, with the time of its reception."""
        updates = [feedback async for feedback in self.feedback()]
        rows = [(feedback.time, feedback.values) for feedback in updates if feedback.values]
        return Table.from_rows(self.title, rows)

    def _repr_html_(self) -> str:
        """Shows state and values in Jupyter."""
        values = "".join(f"<tr><td>{html.escape(k)}</td><td>{html.escape(str(v))}</td></tr>" for k, v in self._latest.values.items())
        return f"<b>{html.escape(self.title)}</b> ({self._latest.state})<table>{values}</table>"

    async def result(self) -> Ending:
        """Waits for its end; :class:`RpiError` if it is unloaded without having run, as who loses a choice is."""
        return await asyncio.shield(self._ending)

    def _hear(self, update: dict[str, Any]) -> None:
        if update.get("gone"):
            self._fail(ConnectionError(GONE))
            return
        state, jump = State(update.get("state", self._latest.state)), update.get("jump", self._latest.jump)
        self._values.update(self._exports.decode(update.get("values", {})))
        self._latest = Feedback(state, self._exports.nest(self._values), jump, time.monotonic() - self.loaded_at)
        self._publish(self._latest)
        if "ending" in update and not self._ending.done():
            ending = read_record(Ending, update["ending"])
            self._ending.set_result(replace(ending, values=self._latest.values))
            self._publish(None)
        elif state is State.UNLOADED:
            self._fail(unloaded_error())

    def _publish(self, news: Feedback | None) -> None:
        for reader in self._readers:
            reader.put_nowait(news)

    def _fail(self, why: Exception) -> None:
        """It will not end any more, unless it has."""
        fail_future(self._ending, why)
        self._publish(None)


@contextlib.contextmanager
def _gone_already() -> Iterator[None]:
    """Ignores that a session or command is not there any more at the end of its block: it was closed in the block, or ended with the
    connection. An error that ended the block counts then."""
    try:
        yield
    except ConnectionError:
        pass
    except RpiError as error:
        if error.code != RpiError.UNKNOWN:
            raise


def fail_future(future: asyncio.Future[Any], why: Exception) -> None:
    """Whoever waits for this learns that it will not come."""
    if not future.done():
        future.set_exception(why)
        # Nobody may be waiting for it; that is no fault.
        future.exception()


def unloaded_error() -> RpiError:
    """Returns the error of an object that was unloaded before it ran."""
    return RpiError(RpiError.UNKNOWN, "it was unloaded before it ran", [])
