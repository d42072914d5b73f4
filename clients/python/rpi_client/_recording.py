"""Recordings: the MCAP files of ``rpi run --record`` and ``rpi serve --record``. Needs the extra ``mcap``."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

from ._drawing import Mark, Span, Svg, draw_timeline
from ._mcap import Attachment, Channel, Metadata, read_records
from ._table import Table

_NANOSECONDS = 1_000_000_000


@dataclass(frozen=True)
class Topic:
    """A topic of a recording: its ``name``, such as ``/device/arm``, the encoding of its messages, and their number."""

    name: str
    encoding: str
    count: int


@dataclass(frozen=True)
class Event:
    """An event of a recording: its ``time`` in seconds since the start of the recording, its ``kind`` (``started``, ``ended``, ``braked``,
    ``overrun``, ...), and what else it says by name, such as ``command`` and ``cause``."""

    time: float
    kind: str
    details: dict[str, Any]


@dataclass
class _Content:
    """What the first pass over a recording collects."""

    start: int | None = None
    end: int = 0
    counts: dict[tuple[str, str], int] = field(default_factory=dict)
    events: list[tuple[int, dict[str, Any]]] = field(default_factory=list)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    parts: list[Path] = field(default_factory=list)
    cut_off: str | None = None

    def add(self, channel: Channel, time: int, data: bytes) -> None:
        """Counts a message, and keeps it if it is an event."""
        key = (channel.topic, channel.encoding)
        self.counts[key] = self.counts.get(key, 0) + 1
        self.start = time if self.start is None else min(self.start, time)
        self.end = max(self.end, time)
        if channel.topic == "/events":
            self.events.append((time, _json_of(_decoder(channel)(data))))


class Recording:
    """A recording, with all its parts (``out.mcap``, ``out.0002.mcap``, ...).

    The files are read from the beginning for each request, and only the requested topic is kept in memory.
    A recording that was cut off is read up to the cut. ``FileNotFoundError`` if there is no such file.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        if not self.path.is_file():
            raise FileNotFoundError(f"{path} is not a file")

    @property
    def topics(self) -> dict[str, Topic]:
        """The topics by name. Topics with flows are ``/command/NAME``, ``/sensors/DEVICE``, ``/set_points/DEVICE`` and ``/device/DEVICE``."""
        topics: dict[str, Topic] = {}
        for (name, encoding), count in self._content.counts.items():
            before = topics[name].count if name in topics else 0
            topics[name] = Topic(name, encoding, before + count)
        return topics

    @property
    def duration(self) -> float:
        """Time from the first to the last message, in seconds."""
        content = self._content
        return (content.end - (content.start or 0)) / _NANOSECONDS

    @property
    def start(self) -> int:
        """Time of the first message in nanoseconds: since the Unix epoch for a run in real time, else since the start of the run."""
        return self._content.start or 0

    @property
    def cut_off(self) -> str | None:
        """The reason for which the recording ends before its run, such as a process that was killed; None if it is complete."""
        return self._content.cut_off

    @property
    def lost_ticks(self) -> int:
        """Number of ticks that are missing because the writer was too slow."""
        return int(self.metadata.get("rpi-end", {}).get("lost", 0))

    @property
    def metadata(self) -> dict[str, dict[str, str]]:
        """The metadata by name: ``rpi`` has the length of a tick and the program, ``rpi-end`` the numbers of recorded and lost ticks."""
        return self._content.metadata

    @property
    def attachments(self) -> dict[str, bytes]:
        """The attached files by name: the description of the cell, and the program."""
        return self._content.attachments

    @property
    def events(self) -> list[Event]:
        """All events."""
        entries = ((time, dict(details)) for time, details in self._content.events)
        return [Event(self._seconds(time), str(details.pop("event", "?")), details) for time, details in entries]

    def table(self, topic: str, *flows: str) -> Table:
        """Returns the messages of a topic as a table, with times in seconds since the start of the recording: all columns, or those of
        these flows. ``KeyError`` for an unknown topic or flow."""
        if topic not in self.topics:
            raise KeyError(f"there is no topic {topic} in {self.path}; there are: {', '.join(self.topics)}")

        def rows() -> Iterator[tuple[float, dict[str, Any]]]:
            decoders: dict[int, Callable[[bytes], dict[str, Any]]] = {}
            for part in self._content.parts:
                for record in read_records(part, topic.__eq__):
                    if isinstance(record, tuple):
                        channel, time, data = record
                        decode = decoders.get(id(channel)) or decoders.setdefault(id(channel), _decoder(channel))
                        yield self._seconds(time), decode(data)

        table = Table.from_rows(topic, rows())
        return table.select("cycle", *flows) if flows and "cycle" in table.columns else table.select(*flows) if flows else table

    def plot(self, topic: str, *flows: str) -> Svg:
        """Draws flows of a topic over time; all of them unless given."""
        return self.table(topic, *flows).plot(*flows)

    def timeline(self) -> Svg:
        """Draws when each command ran, with its result or the cause of its end, and marks what went wrong (overruns, brakes,
        discontinuities, lost ticks)."""
        spans: list[Span] = []
        marks: list[Mark] = []
        running: dict[Any, Event] = {}
        for event in self.events:
            details = event.details
            if event.kind == "started":
                running[details.get("id")] = event
            elif event.kind == "ended" and (begin := running.pop(details.get("id"), None)) is not None:
                label = str(details.get("what") or details.get("cause"))
                failed = details.get("cause") in ("fault", "aborted") or bool(details.get("error"))
                spans.append(Span(str(details.get("command")), label, begin.time, event.time, failed))
            elif event.kind in ("braked", "jumped", "lost", "overrun"):
                marks.append(Mark(event.time, f"{event.kind} at {event.time:.3f} s"))
        for begin in running.values():
            spans.append(Span(str(begin.details.get("command")), "runs on", begin.time, self.duration))
        return draw_timeline(self.path.name, sorted(spans, key=lambda span: span.start), marks)

    def __repr__(self) -> str:
        return f"<Recording {self.path}>"

    def _repr_html_(self) -> str:
        """Shows the topics and the time line in Jupyter."""
        rows = "".join(
            f"<tr><td>{escape(topic.name)}</td><td>{escape(topic.encoding)}</td><td>{topic.count}</td></tr>" for topic in self.topics.values()
        )
        cut = f", cut off: {escape(self.cut_off)}" if self.cut_off else ""
        head = f"<p>{escape(str(self.path))}: {self.duration:.3f} s{cut}</p>"
        return f"{head}<table><tr><th>topic</th><th>encoding</th><th>messages</th></tr>{rows}</table>{self.timeline().text}"

    def _seconds(self, nanoseconds: int) -> float:
        return (nanoseconds - (self._content.start or 0)) / _NANOSECONDS

    @cached_property
    def _content(self) -> _Content:
        content = _Content()
        part: Path | None = self.path
        while part is not None:
            self._scan(part, content)
            end = content.metadata.get("rpi-end", {})
            following = self.path.with_suffix(f".{len(content.parts) + 1:04}.mcap")
            # A file with the next number may be left over from an earlier recording of the same name.
            part = following if "continues" in end and content.cut_off is None and following.is_file() else None
        if content.cut_off is None and ("cut" in end or "ticks" not in end):
            content.cut_off = end.get("cut", "a part is missing" if "continues" in end else "the file has no end")
        return content

    def _scan(self, part: Path, content: _Content) -> None:
        content.parts.append(part)
        content.metadata.pop("rpi-end", None)
        for record in read_records(part, lambda topic: True):
            if isinstance(record, tuple):
                content.add(*record)
            elif isinstance(record, Metadata):
                content.metadata[record.name] = record.values
            elif isinstance(record, Attachment):
                content.attachments[record.name] = record.data
            else:
                content.cut_off = record.reason


def _decoder(channel: Channel) -> Callable[[bytes], dict[str, Any]]:
    """Returns the function that decodes the messages of a channel to nested values."""
    if channel.encoding == "json":
        return lambda data: dict(json.loads(data))
    if channel.encoding != "cdr":
        raise ValueError(f"the messages of {channel.topic} have the encoding {channel.encoding}, which is for `rpi replay`")
    try:
        from mcap_ros2.decoder import DecoderFactory
    except ImportError as error:
        raise ImportError("the profile ros2 needs the package mcap-ros2-support: pip install 'rpi-client[ros2]'") from error
    decode = DecoderFactory().decoder_for(channel.encoding, channel.schema)
    if decode is None:
        raise ValueError(f"the messages of {channel.topic} cannot be decoded")
    return lambda data: _ros_fields(decode(data))


def _ros_fields(message: Any) -> dict[str, Any]:
    """Returns the fields of a ROS 2 message. Fields that are listed in ``absent`` have no value."""
    fields = {name: _ros_value(getattr(message, name)) for name in message.__slots__}
    absent = fields.pop("absent", [])
    fields.pop("header", None)
    return {**fields, **{name: None for name in absent}}


def _ros_value(value: Any) -> Any:
    if hasattr(value, "__slots__"):
        return {name: _ros_value(getattr(value, name)) for name in value.__slots__}
    return [_ros_value(element) for element in value] if isinstance(value, (list, tuple)) else value


def _json_of(fields: dict[str, Any]) -> dict[str, Any]:
    """Returns the content of an event: in the profile ros2 it is a text in JSON."""
    data = fields.get("data")
    return dict(json.loads(data)) if len(fields) == 1 and isinstance(data, str) else fields
