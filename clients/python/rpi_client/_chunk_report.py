"""What the stream of chunks of a policy has measured."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ._chunk import Limit

if TYPE_CHECKING:
    from ._goal import Ending

#: Number of latest delays that are kept.
_KEPT = 10_000

#: Meaning of the codes with which arms reject chunks, as far as they are about chunks only.
_CODES = {35: "chunk invalid", 36: "chunk stale", 37: "chunk full"}


class Delays:
    """Durations in seconds: the latest 10 000 of them, and the number and largest of all."""

    def __init__(self) -> None:
        self._latest: deque[float] = deque(maxlen=_KEPT)
        self.count = 0
        self.most = math.nan

    def add(self, duration: float) -> None:
        """Adds a duration, s."""
        self._latest.append(duration)
        self.count += 1
        self.most = duration if math.isnan(self.most) else max(self.most, duration)

    def quantile(self, share: float) -> float:
        """Returns the smallest duration that at least this share (0 to 1) of the kept ones does not exceed, s; NaN without any."""
        if not self._latest:
            return math.nan
        ascending = sorted(self._latest)
        return ascending[max(math.ceil(share * len(ascending)) - 1, 0)]

    @property
    def median(self) -> float:
        """The median, s."""
        return self.quantile(0.5)

    @property
    def p99(self) -> float:
        """The 99th percentile, s."""
        return self.quantile(0.99)

    def __str__(self) -> str:
        return f"median {1e3 * self.median:.1f} ms, p99 {1e3 * self.p99:.1f} ms, max {1e3 * self.most:.1f} ms ({self.count})"


@dataclass
class ChunkReport:
    """The chunks of a policy in numbers.

    ``sent`` counts the chunks that the server has received, ``accepted`` and ``rejected`` those that the arm has accepted and rejected, ``dropped``
    those that a newer one has replaced before they were sent; ``codes`` has the error codes of rejected chunks, with their number. ``inference`` is the
    time that the policy took, from an observation to its chunk; ``age`` the age of the first row of a chunk when the arm accepted it, by
    the clock of the server; ``in_force`` the time from sending a chunk to the cycle in which the arm accepted it, with an error of at most
    ``clock_uncertainty`` (s). ``late_time`` is the time for which the arm braked or rested because no chunk had come (s). ``deviation`` is the largest distance
    of a joint from the smoothed chunks, ``smoothed`` the largest distance of these from their rows (rad). ``limits`` has the number of ``observations`` in
    which a limit bound, by limit. ``lost_frames`` counts rows that a table of frames does not have because the disk was too slow. ``ending`` is that of the command, None while it runs."""

    sent: int = 0
    accepted: int = 0
    rejected: int = 0
    dropped: int = 0
    codes: dict[int, int] = field(default_factory=dict)
    inference: Delays = field(default_factory=Delays)
    age: Delays = field(default_factory=Delays)
    in_force: Delays = field(default_factory=Delays)
    clock_uncertainty: float = math.inf
    late_time: float = 0.0
    deviation: float = 0.0
    smoothed: float = 0.0
    limits: dict[Limit, int] = field(default_factory=dict)
    observations: int = 0
    lost_frames: int = 0
    ending: Ending | None = None

    @property
    def superseded(self) -> int:
        """Number of chunks that a newer one has replaced while the arm converted their poses; valid once no chunk is on its way."""
        return self.sent - self.accepted - self.rejected

    def note(self, limit: Limit | None, deviation: float, smoothed: float) -> None:
        """Notes an observation: a limit that binds, and the largest distances so far (rad)."""
        self.observations += 1
        self.deviation, self.smoothed = deviation, smoothed
        if limit is not None:
            self.limits[limit] = self.limits.get(limit, 0) + 1

    def _limits_text(self) -> str:
        """Returns the limits that bound, the most frequent one first, with their shares of the observations."""
        frequent = sorted(self.limits.items(), key=lambda entry: -entry[1])[:3]
        return ", ".join(f"{limit} in {100 * count / self.observations:.1f} %" for limit, count in frequent) or "none"

    def __str__(self) -> str:
        codes = ", ".join(f"{count} with code {code} ({_CODES.get(code, 'code of the arm')})" for code, count in self.codes.items())
        lines = [
            f"{self.sent} chunks sent, {self.accepted} accepted, {self.rejected} rejected{': ' + codes if codes else ''}, {self.dropped} dropped",
            f"inference: {self.inference}",
            f"age of the first row: {self.age}",
            f"from sent to in force: {self.in_force}, clocks within {1e3 * self.clock_uncertainty:.1f} ms",
            f"late for {self.late_time:.3f} s",
            f"deviation: {self.deviation:.4f} rad at most, by smoothing {self.smoothed:.4f} rad",
            f"limits that bound: {self._limits_text()}",
        ]
        return "\n".join(lines)
