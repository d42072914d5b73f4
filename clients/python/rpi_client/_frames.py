"""Tables of frames: observations and actions side by side, as Parquet files. Needs the extra ``parquet``."""

from __future__ import annotations

import importlib
import queue
import threading
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

from ._chunk import Observation

#: Number of frames that are written at once, and of those that may wait for the disk.
_GROUP, _WAITING = 500, 5_000


class FrameTable:
    """A Parquet file with a row for each frame, under the names of LeRobot's datasets: ``timestamp`` (s since the first frame), ``frame_index``,
    ``episode_index``, ``observation.*`` and ``action``, and whatever else the frames have.

    Frames are written by a thread. If the disk cannot keep up, frames are lost and counted in ``lost``; nobody waits for the disk. The columns and their
    types are those of the first frames. As a context manager it is complete at the end of the block."""

    def __init__(self, path: str | Path, *, episode: int = 0) -> None:
        try:
            self._arrow = importlib.import_module("pyarrow")
            self._parquet = importlib.import_module("pyarrow.parquet")
        except ImportError as error:
            raise ImportError("a table of frames needs the package pyarrow: pip install 'rpi-client[parquet]'") from error
        self.path = Path(path)
        self.lost = 0
        self._episode = episode
        self._count = 0
        self._start: float | None = None
        self._error: Exception | None = None
        self._waiting: queue.Queue[dict[str, Any] | None] = queue.Queue(_WAITING)
        # The file is opened here, so that a wrong path is an error of the caller.
        self._file = open(self.path, "wb")
        self._thread = threading.Thread(target=self._write, name="frames", daemon=True)
        self._thread.start()

    def __enter__(self) -> FrameTable:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def add(self, time: float, observation: Mapping[str, Any], action: Any, **more: Any) -> None:
        """Adds a frame: its time (s), the observation by name, the action, and further columns. Numbers, lists of numbers and None are values."""
        self._start = time if self._start is None else self._start
        frame = {
            "timestamp": time - self._start,
            "frame_index": self._count,
            "episode_index": self._episode,
            **{f"observation.{name}": value for name, value in observation.items()},
            "action": action,
            **more,
        }
        self._count += 1
        try:
            self._waiting.put_nowait(frame)
        except queue.Full:
            self.lost += 1

    def add_observation(
        self, observation: Observation, action: list[float] | None, channels: Mapping[str, float | None], chunk: int, row: int
    ) -> None:
        """Adds an observation of a stream of chunks, and the row of the chunk whose time has come, with the values of other devices there."""
        numbers = {name: value for name, value in observation.values.items() if isinstance(value, (bool, int, float, list))}
        state = {"state": observation.positions, "velocity": observation.velocities, "pose": _pose_numbers(observation), **numbers}
        self.add(
            observation.server_time,
            state,
            action,
            commanded=observation.commanded,
            chunk=chunk,
            row=row,
            late=observation.late,
            lag=observation.lag,
            deviation=observation.deviation,
            limit=None if observation.limit is None else str(observation.limit),
            **{f"action.{name.removeprefix('channel_')}": value for name, value in channels.items()},
            server_time=observation.server_time,
            client_time=observation.time,
        )

    def close(self) -> None:
        """Writes what waits and completes the file. Raises the error that ended the writing, such as a full disk."""
        if self._thread.is_alive():
            self._waiting.put(None)
            self._thread.join()
        if self._error is not None:
            error, self._error = self._error, None
            raise error

    def _write(self) -> None:
        """Writes the frames in groups until None comes."""
        with self._file:
            try:
                self._write_groups()
            except Exception as error:
                self._error = error
                self._drain()

    def _write_groups(self) -> None:
        writer, frames, is_open = None, [], True
        try:
            while is_open:
                frame = self._waiting.get()
                is_open = frame is not None
                frames += [] if frame is None else [frame]
                if frames and (len(frames) >= _GROUP or not is_open):
                    if writer is None:
                        writer = self._parquet.ParquetWriter(self._file, self._schema(frames))
                    writer.write_table(self._arrow.Table.from_pylist(frames, schema=writer.schema))
                    frames = []
        finally:
            if writer is not None:
                writer.close()

    def _schema(self, frames: list[dict[str, Any]]) -> Any:
        """Returns the types of the columns, from the first frames. There may be no action yet: it is a list of reals then; limits are texts, any other column reals."""
        arrow = self._arrow
        known = {"action": arrow.list_(arrow.float64()), "limit": arrow.string()}
        fields = arrow.Table.from_pylist(frames).schema
        missing = arrow.types.is_null
        return arrow.schema([(one.name, known.get(one.name, arrow.float64()) if missing(one.type) else one.type) for one in fields])

    def _drain(self) -> None:
        """Counts the frames that cannot be written any more."""
        while self._waiting.get() is not None:
            self.lost += 1


def _pose_numbers(observation: Observation) -> list[float]:
    """Returns position (m) and orientation (unit quaternion x, y, z, w) of the tool."""
    return [*observation.pose.position, *observation.pose.orientation]
