"""The connection: JSON-RPC 2.0, a message per line over a Unix socket."""

from __future__ import annotations

import asyncio
import itertools
import json
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable

if TYPE_CHECKING:
    from ._goal import Session

#: A line may not be longer (bytes): what the server grants for a message.
LONGEST = 16 << 20


class RpiError(Exception):
    """What was asked for could not be done.

    ``code`` is one of the server's (see its manual), ``reasons`` has every reason where there are several.
    """

    def __init__(self, code: int, message: str, reasons: list[str]) -> None:
        super().__init__(message)
        self.code = code
        self.reasons = reasons


class Core:
    """A control core."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._listeners: dict[str, list[Callable[[dict[str, Any]], None]]] = {}
        self._task = asyncio.create_task(self._listen())

    async def call(self, method: str, **params: Any) -> Any:
        """Calls a method of the server and gives its result; raises :class:`RpiError`."""
        number = next(self._numbers)
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._waiting[number] = answer
        request = {"jsonrpc": "2.0", "id": number, "method": method, "params": params}
        self._writer.write(json.dumps(request).encode() + b"\n")
        await self._writer.drain()
        return await answer

    async def open_session(self, name: str, on_loss: str = "cancel") -> Session:
        """Opens a session; ``on_loss`` (``cancel``, ``run-on``, ``abort``) says what becomes of its commands without us."""
        from ._goal import Session

        opened = await self.call("session.open", name=name, on_loss=on_loss)
        return Session(self, opened["session"])

    def listen(self, command: str, listener: Callable[[dict[str, Any]], None]) -> None:
        """Hands what the server tells about a command to ``listener``."""
        self._listeners.setdefault(command, []).append(listener)

    async def close(self) -> None:
        """Ends the connection."""
        self._task.cancel()
        self._writer.close()

    async def __aenter__(self) -> Core:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        await self.close()

    async def _listen(self) -> None:
        while line := await self._reader.readline():
            self._hear(json.loads(line))
        for answer in self._waiting.values():
            if not answer.done():
                answer.set_exception(ConnectionError("the control core is gone"))

    def _hear(self, message: dict[str, Any]) -> None:
        if message.get("method") == "update":
            params = message["params"]
            for listener in self._listeners.get(params.get("command", ""), []):
                listener(params)
            return
        answer = self._waiting.pop(message.get("id", 0), None)
        if answer is None or answer.done():
            return
        if "error" in message:
            error = message["error"]
            reasons = error.get("data", {}).get("reasons", [])
            answer.set_exception(RpiError(error["code"], error["message"], reasons))
        else:
            answer.set_result(message["result"])


async def connect(path: str) -> Core:
    """Connects to the control core that listens at this Unix socket."""
    return Core(*await asyncio.open_unix_connection(path, limit=LONGEST))
