"""States and causes by name. Each equals the text that the server sends."""

from __future__ import annotations

from enum import Enum
from typing import TypeVar

_Kind = TypeVar("_Kind", bound="_Word")


class _Word(str, Enum):
    """Word of the protocol. One that only a newer server knows is ``UNKNOWN``."""

    def __str__(self) -> str:
        return str(self.value)

    @classmethod
    def _missing_(cls: type[_Kind], value: object) -> _Kind:
        return cls["UNKNOWN"]


class State(_Word):
    """Where a command is in its life."""

    LOADING = "loading"
    REJECTED = "rejected"
    READY = "ready"
    SCHEDULED = "scheduled"
    RUNNING = "running"
    CANCELLING = "cancelling"
    TERMINATED = "terminated"
    UNLOADED = "unloaded"
    UNKNOWN = "unknown"


class Cause(_Word):
    """Why a command has ended: by a result of its own, as a net does at its last output, by a fault, by a request or the core, by a rule."""

    RESULT = "result"
    TERMINATE = "terminate"
    FAULT = "fault"
    ABORTED = "aborted"
    STOPPED = "stopped by a rule"
    UNKNOWN = "unknown"


class TaskState(_Word):
    """How a task has ended."""

    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"
    UNKNOWN = "unknown"


class OnLoss(_Word):
    """What becomes of the commands of a session without its client: they are cancelled, run on, or are aborted."""

    CANCEL = "cancel"
    RUN_ON = "run-on"
    ABORT = "abort"
