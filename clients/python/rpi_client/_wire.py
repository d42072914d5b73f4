"""How messages travel: in lines over a Unix socket, or over a websocket (RFC 6455), plain or with TLS."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import os
import ssl
from typing import Protocol
from urllib.parse import urlsplit

#: A message may not be longer (bytes): what the server grants.
LONGEST = 16 << 20

#: What a server says when it lets nobody in, at most (bytes).
_WORDS = 1000

_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_TEXT, _CLOSE, _PING, _PONG, _MORE = 0x1, 0x8, 0x9, 0xA, 0x0


class Wire(Protocol):
    """Messages in both directions."""

    async def send(self, text: str) -> None:
        """Sends a message."""

    async def receive(self) -> str | None:
        """The next message; none once the other side is gone."""

    def close(self) -> None:
        """Ends the connection."""


class Lines:
    """A message in a line."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer

    async def send(self, text: str) -> None:
        self._writer.write(text.encode() + b"\n")
        await self._writer.drain()

    async def receive(self) -> str | None:
        line = await self._reader.readline()
        return line.decode() if line else None

    def close(self) -> None:
        self._writer.close()


class WebSocket:
    """A message in a frame or several."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader = reader
        self._writer = writer

    async def greet(self, host: str, token: str | None) -> None:
        """Turns the connection into a websocket; raises :class:`ConnectionError` if the server does not want that."""
        key = base64.b64encode(os.urandom(16))
        head = [
            "GET /rpc HTTP/1.1",
            f"Host: {host}",
            "Upgrade: websocket",
            "Connection: Upgrade",
            "Sec-WebSocket-Version: 13",
            f"Sec-WebSocket-Key: {key.decode()}",
        ]
        if token is not None:
            head.append(f"Authorization: Bearer {token}")
        self._writer.write(("\r\n".join(head) + "\r\n\r\n").encode())
        await self._writer.drain()
        try:
            answer = (await self._reader.readuntil(b"\r\n\r\n")).decode()
        except asyncio.IncompleteReadError as cut:
            raise ConnectionError("the server hung up") from cut
        accept = base64.b64encode(hashlib.sha1(key + _GUID).digest()).decode()
        if " 101 " not in answer.split("\r\n", 1)[0] or accept not in answer:
            words = (await self._reader.read(_WORDS)).decode(errors="replace").strip()
            status = answer.split("\r\n", 1)[0].removeprefix("HTTP/1.1 ")
            raise ConnectionError(f"{status}: {words}" if words else status)

    async def send(self, text: str) -> None:
        await self._send(_TEXT, text.encode())

    async def receive(self) -> str | None:
        message = b""
        try:
            while True:
                last, kind, payload = await self._frame()
                if kind == _PING:
                    await self._send(_PONG, payload)
                elif kind == _CLOSE:
                    return None
                elif kind in (_TEXT, _MORE):
                    message += payload
                    if last:
                        return message.decode()
        except (asyncio.IncompleteReadError, ConnectionError):
            return None

    def close(self) -> None:
        self._writer.close()

    async def _frame(self) -> tuple[bool, int, bytes]:
        """A frame of the server, which does not mask: whether it is the last of its message, its kind, what is in it."""
        first, second = await self._reader.readexactly(2)
        length = second & 0x7F
        if length >= 126:
            length = int.from_bytes(await self._reader.readexactly(2 if length == 126 else 8), "big")
        if length > LONGEST:
            raise ConnectionError("a message that is too long")
        return bool(first & 0x80), first & 0x0F, await self._reader.readexactly(length)

    async def _send(self, kind: int, payload: bytes) -> None:
        """Sends a frame, masked as clients must."""
        length = len(payload)
        size = bytes([0x80 | length]) if length < 126 else bytes([0xFE]) + length.to_bytes(2, "big")
        if length > 0xFFFF:
            size = bytes([0xFF]) + length.to_bytes(8, "big")
        mask = os.urandom(4)
        pattern = int.from_bytes((mask * (length // 4 + 1))[:length], "big")
        masked = (int.from_bytes(payload, "big") ^ pattern).to_bytes(length, "big")
        self._writer.write(bytes([0x80 | kind]) + size + mask + masked)
        await self._writer.drain()


async def open_wire(address: str, token: str | None, tls: ssl.SSLContext | None) -> Wire:
    """Opens a connection to ``ws://host:port``, ``wss://host:port``, or else to the Unix socket of that path."""
    url = urlsplit(address)
    if "://" in address and url.scheme not in ("ws", "wss"):
        raise ValueError(f"{address} is neither ws://host:port nor wss://host:port, nor the path of a Unix socket")
    if token is not None and not token.isprintable():
        raise ValueError("a token of printable characters is needed")
    if url.scheme not in ("ws", "wss"):
        return Lines(*await asyncio.open_unix_connection(address, limit=LONGEST))
    context = (tls or ssl.create_default_context()) if url.scheme == "wss" else None
    if url.hostname is None or url.port is None:
        raise ValueError(f"{address} names no host and port")
    reader, writer = await asyncio.open_connection(url.hostname, url.port, ssl=context, limit=LONGEST)
    wire = WebSocket(reader, writer)
    try:
        await wire.greet(url.netloc, token)
    except BaseException:
        writer.close()
        raise
    return wire
