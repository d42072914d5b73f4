"""Records of MCAP files (https://mcap.dev/spec) in their order, without the index, which a file that was cut off does not have.

The package ``mcap`` reads everything but the messages in a chunk: it makes an object of each field, which takes ten times as long as the
rest, and a recording has a message per topic and millisecond."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, Union


@dataclass(frozen=True)
class Channel:
    """A channel: the ``topic``, the ``encoding`` of its messages, and the schema of the package ``mcap``; None without one."""

    topic: str
    encoding: str
    schema: Any


@dataclass(frozen=True)
class Metadata:
    """Metadata by their name."""

    name: str
    values: dict[str, str]


@dataclass(frozen=True)
class Attachment:
    """An attached file."""

    name: str
    data: bytes


@dataclass(frozen=True)
class Cut:
    """The reason for which the file cannot be read further."""

    reason: str


#: A message: its channel, its time in nanoseconds, and its content.
Message = tuple[Channel, int, bytes]
Record = Union[Message, Metadata, Attachment, Cut]

_HEAD = struct.Struct("<BQ")
#: Channel, sequence number, time of the message, time of its publication.
_MESSAGE = struct.Struct("<HIQQ")
_SCHEMA, _CHANNEL, _MESSAGE_OPCODE = 3, 4, 5


def read_records(path: Path, wanted: Callable[[str], bool]) -> Iterator[Record]:
    """Yields the records of a file: messages of the wanted topics, metadata and attachments. The last one is a :class:`Cut` if the file is
    damaged or has no end; every checksum is verified."""
    try:
        import mcap.records as records
        from mcap.exceptions import EndOfFile, McapError
        from mcap.stream_reader import StreamReader
    except ImportError as error:
        raise ImportError("reading recordings needs the package mcap: pip install 'rpi-client[mcap]'") from error
    # Beside its own errors, the package lets those of decompression, of text and of `struct` through.
    others = (ValueError, EOFError, RuntimeError, struct.error, LookupError, MemoryError)
    errors: tuple[type[Exception], ...] = (McapError, *others, *_decompression_errors())
    channels = _Channels(wanted)
    with path.open("rb") as file:
        try:
            for record in StreamReader(file, emit_chunks=True, validate_crcs=True, record_size_limit=_LARGEST).records:
                if isinstance(record, records.Chunk):
                    yield from channels.messages(record)
                elif isinstance(record, (records.Schema, records.Channel)):
                    channels.add(record)
                elif isinstance(record, records.Metadata):
                    yield Metadata(record.name, dict(record.metadata))
                elif isinstance(record, records.Attachment):
                    yield Attachment(record.name, record.data)
        except errors as error:
            ends = isinstance(error, EndOfFile)
            yield Cut("the file ends in the middle of a record" if ends else f"the file is damaged: {error}")


#: Largest record that is read, in bytes: `rpi` writes chunks of 1 MiB, and attaches programs.
_LARGEST = 2**30


def _decompression_errors() -> tuple[type[Exception], ...]:
    try:
        from zstandard import ZstdError
    except ImportError:
        return ()
    return (ZstdError,)


class _Channels:
    """The schemas and channels that were read so far."""

    def __init__(self, wanted: Callable[[str], bool]) -> None:
        self._wanted = wanted
        self._schemas: dict[int, Any] = {}
        #: The wanted channels by number.
        self._channels: dict[int, Channel] = {}

    def add(self, record: Any) -> None:
        """Adds a schema or a channel."""
        if hasattr(record, "topic"):
            if self._wanted(record.topic):
                self._channels[record.id] = Channel(record.topic, record.message_encoding, self._schemas.get(record.schema_id))
        else:
            self._schemas[record.id] = record

    def messages(self, chunk: Any) -> Iterator[Message]:
        """Yields the messages of the wanted channels in a chunk."""
        from mcap.data_stream import ReadDataStream
        from mcap.records import Channel as ChannelRecord
        from mcap.records import Schema
        from mcap.stream_reader import get_chunk_data_stream

        if chunk.uncompressed_size > _LARGEST:
            raise ValueError(f"a chunk of {chunk.uncompressed_size} bytes is too large")
        stream, length = get_chunk_data_stream(chunk, validate_crc=True)
        data, start = stream.read(length), 0
        while start < length:
            opcode, size = _HEAD.unpack_from(data, start)
            start += _HEAD.size
            if start + size > length:
                raise ValueError("a record is longer than its chunk")
            if opcode == _MESSAGE_OPCODE:
                number, _, time, _ = _MESSAGE.unpack_from(data, start)
                channel = self._channels.get(number)
                if channel is not None:
                    yield channel, time, data[start + _MESSAGE.size : start + size]
            elif opcode in (_SCHEMA, _CHANNEL):
                kind = Schema if opcode == _SCHEMA else ChannelRecord
                self.add(kind.read(ReadDataStream(BytesIO(data[start : start + size]))))
            start += size
