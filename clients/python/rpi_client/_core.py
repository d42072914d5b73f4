"""The connection: JSON-RPC 2.0."""

from __future__ import annotations

import asyncio
import itertools
import json
import ssl
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable

from ._states import OnLoss
from ._wire import Wire, open_wire

if TYPE_CHECKING:
    from ._goal import Session


#: Message of the error that pending calls get when the connection ends.
GONE = "the control core is gone"


class RpiError(Exception):
    """The server rejected a request.

    ``code`` is one of the server's (see its manual), ``reasons`` has every reason where there are several.
    """

    #: Code of a request about an object that does not exist.
    UNKNOWN = -32001
    #: Code of a request for which the role of the client has no right.
    FORBIDDEN = -32009

    def __init__(self, code: int, message: str, reasons: list[str]) -> None:
        super().__init__(message)
        self.code = code
        self.reasons = reasons


@dataclass(frozen=True)
class Identity:
    """Who this client is to the server: the ``name`` of its token (None without one), its ``role`` (``viewer``, ``operator``,
    ``programmer`` or ``admin``), and the ``rights`` of the role (``watch``, ``stop``, ``move``, ``load``, ``reset``, ``release``, ``manage``)."""

    name: str | None
    role: str
    rights: tuple[str, ...]


@dataclass(frozen=True)
class DeviceInfo:
    """A device of the server's cell: its ``name`` in programs, its ``kind``, such as ``arm``, and for an arm the number of its axes."""

    name: str
    kind: str
    joint_count: int | None


class Core:
    """A control core."""

    def __init__(self, wire: Wire) -> None:
        self._wire = wire
        self._gone = False
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._listeners: dict[str, list[Callable[[dict[str, Any]], None]]] = {}
        self._task = asyncio.create_task(self._listen())

    async def call(self, method: str, **params: Any) -> Any:
        """Calls a method of the server and gives its result; raises :class:`RpiError`."""
        if self._gone:
            raise ConnectionError(GONE)
        number = next(self._numbers)
        request = {"jsonrpc": "2.0", "id": number, "method": method, "params": params}
        # JSON has no NaN and no infinity: a ValueError here, before anybody waits for the answer.
        text = json.dumps(request, allow_nan=False)
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._waiting[number] = answer
        try:
            await self._wire.send(text)
        except BaseException:
            # Nobody waits for the answer any more.
            self._waiting.pop(number, None)
            raise
        return await answer

    async def open_session(self, name: str, on_loss: OnLoss | str = OnLoss.CANCEL, grace: float | None = None) -> Session:
        """Opens a session; ``on_loss`` says what becomes of its commands without us, and
        ``grace`` within how many seconds a cancelled command must end before it is aborted."""
        from ._goal import Session

        opened = await self.call("session.open", name=name, on_loss=str(on_loss), grace=grace)
        return Session(self, opened["session"])

    async def identity(self) -> Identity:
        """Returns the name, the role and the rights of this client, by its token or its Unix socket."""
        described = await self.call("client.describe")
        return Identity(described["name"], described["role"], tuple(described["rights"]))

    async def devices(self) -> list[DeviceInfo]:
        """Returns the devices of the server's cell."""
        listed = await self.call("device.list")
        counts = (device["interfaces"].get("robotarm", {}).get("jointcount") for device in listed["devices"])
        devices = zip(listed["devices"], counts, strict=True)
        return [DeviceInfo(d["name"], d["type"], None if count is None else int(count)) for d, count in devices]

    async def emergency_stop(self, by: str = "a client") -> None:
        """Stops everything at once, whoever it belongs to; nothing can be started until :meth:`reset_emergency`."""
        await self.call("emergency.stop", by=by)

    async def reset_emergency(self) -> None:
        """Lets commands start again after an emergency stop; :class:`RpiError` while devices are still braking, and if the
        operator requested the stop and the role of this client is neither ``operator`` nor ``admin``."""
        await self.call("emergency.reset")

    async def set_override(self, share: float) -> None:
        """Sets the share of the speed, 0 to 1, at which all motions of the library go, whoever they belong to."""
        await self.call("motion.set", override=share)

    async def pause(self) -> None:
        """Pauses all motions of the library: they come to rest on their paths until :meth:`resume`."""
        await self.call("motion.set", paused=True)

    async def resume(self) -> None:
        """Lets all motions go on along their paths after :meth:`pause`."""
        await self.call("motion.set", paused=False)

    def listen(self, command: str, listener: Callable[[dict[str, Any]], None]) -> None:
        """Hands what the server tells about a command or task to ``listener``, until it is unloaded."""
        self._listeners.setdefault(command, []).append(listener)

    async def close(self) -> None:
        """Ends the connection."""
        self._task.cancel()
        self._wire.close()

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
        try:
            while (message := await self._wire.receive()) is not None:
                self._hear(json.loads(message))
        finally:
            self._lose()

    def _lose(self) -> None:
        """The connection has ended: whoever waits learns so."""
        self._gone = True
        for answer in self._waiting.values():
            if not answer.done():
                answer.set_exception(ConnectionError(GONE))
                # A call whose request could not be sent does not wait for its answer any more.
                answer.exception()
        for listeners in self._listeners.values():
            for listener in listeners:
                listener({"gone": True})

    def _hear(self, message: dict[str, Any]) -> None:
        if message.get("method") == "update":
            params = message["params"]
            about = params.get("command") or params.get("task", "")
            for listener in self._listeners.get(about, []):
                listener(params)
            if params.get("state") == "unloaded":
                self._listeners.pop(about, None)
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


async def connect(address: str, *, token: str | None = None, tls: ssl.SSLContext | None = None) -> Core:
    """Connects to a control core: at ``ws://host:port`` or ``wss://host:port``, or at the Unix socket of that path.

    ``token`` is shown if the server wants one; ``tls`` says whom to trust, the system's authorities unless given.
    """
    return Core(await open_wire(address, token, tls))
