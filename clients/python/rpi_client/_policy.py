"""The forms in which a policy can be given, and what waits between a policy and the server."""

from __future__ import annotations

import asyncio
import contextlib
import inspect
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable
from typing import Any, Literal, Union, cast

from ._chunk import Chunk, Observation, Rows

#: What a policy returns for an observation: a chunk, its rows alone, or None to end.
Result = Union[Chunk, Rows, None]

#: A policy: a function or coroutine function of an observation, an async generator function of all observations, or an async iterator.
Policy = Union[
    Callable[[Observation], Result],
    Callable[[Observation], Awaitable[Result]],
    Callable[[AsyncIterator[Observation]], AsyncIterator[Union[Chunk, Rows]]],
    AsyncIterator[Union[Chunk, Rows]],
]

#: What becomes of a chunk that waits to be sent when the next one comes: it is replaced, or the next one waits behind it.
Backlog = Literal["latest", "queue"]


async def chunks_of(policy: Policy, observations: AsyncIterator[Observation]) -> AsyncGenerator[Chunk | Rows, None]:
    """Yields the chunks of a policy in any of its forms. A plain function runs in a thread, where it does not block the event loop.
    ``TypeError`` for anything else."""
    if isinstance(policy, AsyncIterator):
        source: AsyncIterator[Any] = policy
    elif inspect.isasyncgenfunction(policy):
        source = cast(Callable[[AsyncIterator[Observation]], AsyncIterator[Any]], policy)(observations)
    elif callable(policy):
        source = _results(policy, observations)
    else:
        raise TypeError(f"{policy!r} is neither a function of an observation nor an async iterator of chunks")
    # A generator is closed here and not some time later, so that what it holds (a camera) is free when the motion has ended.
    async with contextlib.AsyncExitStack() as stack:
        if isinstance(source, AsyncGenerator):
            await stack.enter_async_context(contextlib.aclosing(source))
        async for chunk in source:
            yield chunk


async def _results(policy: Callable[..., Any], observations: AsyncIterator[Observation]) -> AsyncIterator[Chunk | Rows]:
    is_async = inspect.iscoroutinefunction(policy) or inspect.iscoroutinefunction(getattr(policy, "__call__", None))
    async for observation in observations:
        result = await policy(observation) if is_async else await asyncio.to_thread(policy, observation)
        # A plain function may return a coroutine, as `functools.partial` and `lambda` do.
        result = await result if inspect.isawaitable(result) else result
        if result is None:
            return
        yield result


class Mailbox:
    """Chunks that wait to be sent: the latest one, or at most ``depth`` in their order, for whose room the policy waits."""

    def __init__(self, backlog: Backlog, depth: int) -> None:
        if backlog not in ("latest", "queue"):
            raise ValueError(f"backlog is {backlog!r}, neither 'latest' nor 'queue'")
        if depth < 1:
            raise ValueError(f"depth is {depth}, and at least 1 is needed")
        self._keeps_all = backlog == "queue"
        self._waiting: asyncio.Queue[Chunk | None] = asyncio.Queue(depth if self._keeps_all else 1)
        self.dropped = 0

    async def put(self, chunk: Chunk) -> None:
        """Puts a chunk in. ``ValueError`` for one that is appended if it could be dropped: the next one would be appended to another place."""
        if not self._keeps_all:
            if chunk.append:
                raise ValueError("a chunk that is appended needs backlog='queue'")
            if self._waiting.full():
                self._waiting.get_nowait()
                self.dropped += 1
        await self._waiting.put(chunk)

    async def close(self) -> None:
        """Lets :meth:`chunks` end after the last chunk."""
        await self._waiting.put(None)

    async def chunks(self) -> AsyncIterator[Chunk]:
        """Yields the chunks until :meth:`close`."""
        while (chunk := await self._waiting.get()) is not None:
            yield chunk
