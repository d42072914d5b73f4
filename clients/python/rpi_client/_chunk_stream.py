"""Chunks of a policy on their way to an arm, and observations on their way back."""

from __future__ import annotations

import asyncio
import contextlib
import math
import time
from collections.abc import AsyncIterator
from dataclasses import replace
from types import TracebackType
from typing import TYPE_CHECKING, Any

from ._chunk import MOST_WAITING, POSE_NUMBERS, Chunk, Observation, Rows, SentChunk, channel_of, column_of, lengthened, limit_of, padded, poses_of, rows_of
from ._chunk_program import channel_key
from ._chunk_report import ChunkReport
from ._clock import ServerClock
from ._core import RpiError
from ._policy import Backlog, Mailbox, Policy, chunks_of
from ._states import State

if TYPE_CHECKING:
    from ._frames import FrameTable
    from ._goal import Ending, Feedback, Goal

#: Number of sent chunks of which the rows are kept, for the frames and the delays.
_KEPT = 256

#: Number of late observations that follow each other without a pause.
_MADE_UP = 3

#: Rows that are left free when a chunk is appended: the time until the last row is known with the delay of the feedback.
_SPARE = 10

#: Longest time by which the news of an end come after the answer to a request that was too late for it, s.
_NEWS = 2.0

#: Flows of a command that the stream reads itself.
_OWN = (
    "clock seen taken accepted accepted_count rejected rejected_count late_time resting row lag remaining late "
    "position velocity commanded measured deviation axis limit most_deviation most_smoothed"
).split()


class ChunkStream:
    """Sends chunks of joint positions to a command that follows them, and receives observations.

    ``goal`` is a loaded command: that of :meth:`Arm.open_chunks`, or one that you have made from :meth:`Arm.chunk_program`. It has the inputs
    ``number``, ``count``, ``observed`` and ``positions`` (or ``poses``), which are set between the same two cycles, and the exports of this program. ``frames``
    is a table that gets a row for each observation. ``period`` is the time between two rows (s): with it, :meth:`run` sends a chunk that is appended when
    the arm has room for it.

    As a context manager it starts the command, and at the end of the block it stops the arm on its path and unloads the command.
    ``ValueError`` if the command lacks an input or export."""

    def __init__(self, goal: Goal, frames: FrameTable | None = None, period: float | None = None) -> None:
        self.goal = goal
        self._period = period
        #: Estimated time of the last row of all chunks that were sent to be appended, by the clock of the command, s.
        self._last_row = 0.0
        #: Number of rejected chunks when the last one was sent.
        self._rejected_before = 0
        self.clock = ServerClock()
        self.report = ChunkReport()
        self._has_poses = "poses" in goal.inputs
        array = "poses" if self._has_poses else "positions"
        missing = [name for name in ("number", "count", "observed", array) if name not in goal.inputs]
        flows = {name.partition("[")[0] for name in goal.exports}
        missing += [name for name in _OWN if name not in flows]
        if missing:
            raise ValueError(f"{goal.title} has no {', '.join(missing)}; `Arm.chunk_program` returns a program that has them")
        self.joint_count = sum(name.startswith("position[") for name in goal.exports)
        self.rows = goal.inputs[array].shape[0] // (1 if self._has_poses else self.joint_count)
        self._channels = [name for name in goal.inputs if name.startswith("channel_")]
        self._frames = frames
        self._sent: dict[int, SentChunk] = {}
        self._number = 0
        self._latest: Observation | None = None
        self._ended = False
        #: No further chunk will come: the arm is not late when it brakes.
        self._is_complete = False
        self._news = asyncio.Condition()
        self._reader: asyncio.Task[None] | None = None

    async def __aenter__(self) -> ChunkStream:
        self._reader = asyncio.create_task(self._read())
        try:
            begin = time.monotonic()
            await self.goal.start()
            # The clock of the command was not yet 0 when its start was requested.
            self.clock.note_sent(begin, 0.0)
            async with self._news:
                await self._news.wait_for(lambda: self._has_ended() or self._latest is not None)
        except BaseException as error:
            await self.__aexit__(type(error), error, None)
            raise
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.goal.__aexit__(kind, error, trace)
        if self._reader is not None:
            self._reader.cancel()
            await asyncio.gather(self._reader, return_exceptions=True)
        if self._frames is not None:
            self.report.lost_frames = self._frames.lost

    @property
    def latest(self) -> Observation | None:
        """The latest observation; None before the first one."""
        return self._latest

    async def observations(self, every: float = 0.0) -> AsyncIterator[Observation]:
        """Yields the newest observation again and again, on average at most once in ``every`` seconds, until the command has ended. A slow reader
        misses observations and never gets an old one. ``ValueError`` if ``every`` is negative or not a number."""
        if not every >= 0.0:
            raise ValueError(f"every is {every}, not a number of seconds from 0 on")
        due, last = time.monotonic(), 0
        while True:
            left = due - time.monotonic()
            if left > 0:
                # A sleep that is over already would cost a turn of the event loop, which a busy loop has few of.
                await asyncio.sleep(left)
            # A late observation does not shift the next ones. A few are made up for, so that stalls do not lower the rate.
            due = max(due + every, time.monotonic() - _MADE_UP * every)
            async with self._news:
                await self._news.wait_for(lambda: self._has_ended() or (self._latest is not None and self._latest.number > last))
            if self._has_ended() or self._latest is None:
                return
            last = self._latest.number
            yield self._latest

    async def send(self, chunk: Chunk | Rows) -> int:
        """Sends a chunk and returns its number, when the server has handed it to the command. ``TypeError`` and ``ValueError`` for a chunk that
        cannot be sent, :class:`RpiError` if the command has ended."""
        if self._has_ended():
            # The server accepts inputs of a command that has ended.
            raise RpiError(RpiError.UNKNOWN, f"{self.goal.title} has ended", [])
        chunk = chunk if isinstance(chunk, Chunk) else Chunk(chunk)
        rows = self._rows_of(chunk)
        values = self._arrays(chunk, rows)
        columns = self._columns(chunk, len(rows))
        values.update({name: lengthened(column, self.rows) for name, column in columns.items()})
        observed, start = self._start_of(chunk.observed)
        self._number += 1
        number = self._number
        self._keep(SentChunk(number, time.monotonic(), start, rows, columns))
        self._rejected_before = self.goal.latest.values["rejected_count"]
        try:
            await self.goal.set(number=number, observed=observed, **values)
        except (TypeError, ValueError):
            # Raised before anything was sent, and before another chunk could get a number.
            self._number -= 1
            raise
        self.report.sent += 1
        return number

    async def run(self, policy: Policy, *, every: float = 0.0, backlog: Backlog = "latest", depth: int = 4) -> ChunkReport:
        """Lets a policy move the arm until it ends or the command does, and returns the report. After the last chunk the arm goes on to its last row.

        If the policy raises an error or this call is cancelled, the arm stops on its path at once. Parameters as in :meth:`Arm.chunks`."""
        mailbox = Mailbox(backlog, depth)
        work = asyncio.create_task(self._work(policy, mailbox, every))
        ended = asyncio.create_task(self.goal.result())
        try:
            await asyncio.wait({work, ended}, return_when=asyncio.FIRST_COMPLETED)
            if not ended.done() and not await self._was_too_late(work):
                work.result()
                self._is_complete = True
                await self._rest()
        finally:
            # No further chunk is sent before the arm is stopped.
            for task in (work, ended):
                task.cancel()
            await asyncio.gather(work, ended, return_exceptions=True)
            self.report.dropped += mailbox.dropped
            self.report.ending = await self._stop()
        return self.report

    async def _was_too_late(self, work: asyncio.Task[None]) -> bool:
        """Whether a chunk was rejected because the command had ended: the news of the end comes after the answer then."""
        if isinstance(work.exception(), RpiError):
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self.goal.result(), _NEWS)
        return self._has_ended()

    async def _work(self, policy: Policy, mailbox: Mailbox, every: float) -> None:
        """Produces and sends chunks until the policy ends."""
        tasks = [asyncio.create_task(self._produce(policy, mailbox, every)), asyncio.create_task(self._deliver(mailbox))]
        try:
            await asyncio.gather(*tasks)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    async def _produce(self, policy: Policy, mailbox: Mailbox, every: float) -> None:
        given: list[tuple[Observation, float]] = []

        async def handed_over() -> AsyncIterator[Observation]:
            async for observation in self.observations(every):
                given[:] = [(observation, time.monotonic())]
                yield observation

        async with contextlib.aclosing(chunks_of(policy, handed_over())) as source:
            async for result in source:
                chunk = result if isinstance(result, Chunk) else Chunk(result)
                for observation, given_at in given:
                    self.report.inference.add(time.monotonic() - given_at)
                    chunk = chunk if chunk.observed is not None else replace(chunk, observed=observation)
                await mailbox.put(chunk)
        await mailbox.close()

    async def _deliver(self, mailbox: Mailbox) -> None:
        async for chunk in mailbox.chunks():
            count = len(self._rows_of(chunk))
            if chunk.append and self._number > 0:
                await self._room(count)
            self._last_row = self.goal.latest.values["clock"] + self._left() + count * (self._period or 0.0)
            await self.send(chunk)

    def _left(self) -> float:
        """Returns the time until the last row of all chunks, s. The feedback does not have the chunk that the arm has just accepted."""
        values = self.goal.latest.values
        return float(max(values["remaining"], self._last_row - values["clock"], 0.0))

    async def _room(self, count: int) -> None:
        """Waits until the arm has room for ``count`` further rows, or the command has ended. :class:`RpiError` if the arm has rejected the chunk
        before: the next one would be appended to another place."""
        room = math.inf if self._period is None else (MOST_WAITING - _SPARE - count) * self._period

        def is_decided() -> bool:
            values = self.goal.latest.values
            return bool(values["accepted"] == self._number or values["rejected_count"] > self._rejected_before)

        def has_room() -> bool:
            return self._has_ended() or (is_decided() and self._left() <= room)

        async with self._news:
            await self._news.wait_for(has_room)
        values = self.goal.latest.values
        if not self._has_ended() and values["accepted"] != self._number:
            text = f"chunk {self._number} is rejected with code {values['rejected']}, so no chunk can be appended to it"
            raise RpiError(RpiError.UNKNOWN, text, [])

    async def _rest(self) -> None:
        """Waits until the arm rests at the last row of the last chunk, or the command has ended."""

        def rests() -> bool:
            values = self.goal.latest.values
            is_idle = values["resting"] or values["accepted"] == 0
            return self._has_ended() or (values["seen"] == self._number and is_idle)

        async with self._news:
            await self._news.wait_for(rests)

    async def _stop(self) -> Ending:
        """Stops the arm on its path, if the command runs, and waits for its end."""
        if self.goal.latest.state is State.RUNNING:
            await self.goal.preempt()
        ending = await self.goal.result()
        if self._reader is not None:
            # The last feedback has the final counts.
            await self._reader
        return ending

    def _has_ended(self) -> bool:
        return self._ended or self.goal.latest.state in (State.TERMINATED, State.UNLOADED)

    def _rows_of(self, chunk: Chunk) -> list[list[float]]:
        if self._has_poses:
            return rows_of("poses", chunk.positions, POSE_NUMBERS, self.rows)
        return rows_of("positions", chunk.positions, self.joint_count, self.rows)

    def _arrays(self, chunk: Chunk, rows: list[list[float]]) -> dict[str, Any]:
        """Returns the inputs with the rows of a chunk and its options."""
        values: dict[str, Any] = {"count": len(rows)}
        if self._has_poses:
            values["poses"] = lengthened(poses_of(rows), self.rows)
        else:
            values["positions"] = padded(rows, self.rows)
        if chunk.velocities is not None:
            velocities = rows_of("velocities", chunk.velocities, self.joint_count, self.rows)
            if len(velocities) != len(rows):
                raise ValueError(f"velocities: {len(rows)} rows are needed, and there are {len(velocities)}")
            values["velocities"] = padded(velocities, self.rows)
        elif "velocities" in self.goal.inputs:
            # The arm would follow the rows with those of an earlier chunk.
            raise ValueError("velocities: this stream needs a velocity at each row")
        if not 0 <= chunk.frozen <= len(rows):
            raise ValueError(f"frozen is {chunk.frozen}, not from 0 to {len(rows)}, the number of rows")
        options: dict[str, Any] = {"append": chunk.append, "frozen": chunk.frozen}
        # A command of another program need not have them while they have their defaults.
        values.update({name: value for name, value in options.items() if value or name in self.goal.inputs})
        return values

    def _columns(self, chunk: Chunk, count: int) -> dict[str, list[float]]:
        """Returns the inputs with the values of other devices. ``ValueError`` if a chunk lacks one that the command has."""
        if chunk.append and (self._channels or "widths" in self.goal.inputs):
            # The arm would read the values of the new chunk while it executes the last rows of the one before.
            raise ValueError("a chunk with values of a gripper or another device cannot be appended")
        columns = {}
        if chunk.widths is not None:
            columns["widths"] = column_of("widths", chunk.widths, count)
        elif "widths" in self.goal.inputs:
            raise ValueError("widths: the gripper of this stream needs an opening at each row")
        columns.update({channel_key(name): channel_of(name, values, count) for name, values in chunk.channels.items()})
        missing = [name for name in self._channels if name not in columns]
        if missing:
            raise ValueError(f"channels: {missing[0].removeprefix('channel_')} of this stream needs a value at each row")
        return columns

    def _start_of(self, observed: Observation | float | None) -> tuple[float, float]:
        """Returns the time of the first row by the server's clock and by the one here, s."""
        if isinstance(observed, Observation):
            return observed.server_time, observed.time
        here = time.monotonic() if observed is None else float(observed)
        return self.clock.to_server(here), here

    def _keep(self, chunk: SentChunk) -> None:
        self._sent[chunk.number] = chunk
        self._sent.pop(chunk.number - _KEPT, None)

    async def _read(self) -> None:
        """Reads the feedback of the command until its end."""
        try:
            async for feedback in self.goal.feedback():
                if "clock" in feedback.values:
                    self._take(feedback)
                    async with self._news:
                        self._news.notify_all()
        finally:
            # Those who wait for an observation see that there will be none.
            self._ended = True
            async with self._news:
                self._news.notify_all()

    def _take(self, feedback: Feedback) -> None:
        values = feedback.values
        server = values["clock"]
        if self._latest is not None and server <= self._latest.server_time:
            return
        self.clock.note_received(self.goal.loaded_at + feedback.time, server)
        self._note_acceptance(values)
        self._latest = Observation(
            number=1 if self._latest is None else self._latest.number + 1,
            server_time=server,
            time=self.clock.to_client(server),
            positions=values["position"],
            velocities=values["velocity"],
            commanded=values["commanded"],
            pose=values["measured"],
            accepted=values["accepted"],
            remaining=values["remaining"],
            lag=values["lag"],
            deviation=values["deviation"],
            limit=limit_of(values["axis"], values["limit"]),
            late=values["late"],
            values={name: value for name, value in values.items() if name not in _OWN},
        )
        self.report.note(self._latest.limit, values["most_deviation"], values["most_smoothed"])
        if self._frames is not None:
            self._frames.add_observation(self._latest, *self._action(values), values["accepted"], values["row"])

    def _note_acceptance(self, values: dict[str, Any]) -> None:
        """Notes that a chunk has been accepted or rejected since the last feedback."""
        self.report.accepted = values["accepted_count"]
        if not self._is_complete:
            self.report.late_time = values["late_time"]
        before = self._latest.accepted if self._latest is not None else 0
        chunk = self._sent.get(values["accepted"])
        if chunk is not None and values["accepted"] != before:
            self.clock.note_sent(chunk.sent, values["taken"])
            self.report.in_force.add(max(self.clock.to_client(values["taken"]) - chunk.sent, 0.0))
            self.report.age.add(values["taken"] - self.clock.to_server(chunk.start))
            self.report.clock_uncertainty = self.clock.uncertainty
        if values["rejected_count"] > self.report.rejected:
            code = values["rejected"]
            self.report.codes[code] = self.report.codes.get(code, 0) + values["rejected_count"] - self.report.rejected
            self.report.rejected = values["rejected_count"]

    def _action(self, values: dict[str, Any]) -> tuple[list[float] | None, dict[str, float | None]]:
        """Returns the row of the accepted chunk whose time has come, and the values of other devices there; None without a chunk."""
        names = [name for name in ("widths", *self._channels) if name in self.goal.inputs]
        chunk = self._sent.get(values["accepted"])
        if chunk is None:
            return None, dict.fromkeys(names)
        row = min(max(values["row"], 0), len(chunk.rows) - 1)
        return chunk.rows[row], {name: chunk.channels[name][row] for name in names}
