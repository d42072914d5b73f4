"""The clock of the server beside that of this process."""

from __future__ import annotations

import math
import time

#: Rate by which the two clocks may drift apart (s per s): that of cheap quartz, and of a clock that is being slewed.
_DRIFT = 5e-4

#: Time in which late cycles are forgotten, s.
_MEMORY = 5.0


class ServerClock:
    """Relation between the clock of a command at the server (seconds since its start, counted in cycles) and ``time.monotonic()`` here.

    A message that the server received after it was sent here gives a lower bound of the offset, one that it sent before it was
    received here an upper bound. The estimate is the middle of the tightest bounds (K. Marzullo, S. Owicki, "Maintaining the time in a
    distributed system", 1983). A delay of a message, as by a busy event loop, makes its own bound loose and no other one wrong;
    an average of round trips would be shifted by each of them.
    """

    def __init__(self) -> None:
        self._lower: tuple[float, float] | None = None
        self._upper: tuple[float, float] | None = None
        #: Newest contradiction between the bounds, s, and when it was noted.
        self._contradiction = (0.0, 0.0)

    def note_sent(self, here: float, server: float) -> None:
        """Notes that what the server did at ``server`` was sent from here at ``here``, so not before (both s)."""
        now, bound = time.monotonic(), here - server
        if self._lower is None or bound > self._at(self._lower, now, -_DRIFT):
            self._lower = (bound, now)
        if self._upper is not None and bound > self._at(self._upper, now, _DRIFT):
            self._upper = self._contradicted(bound, self._at(self._upper, now, _DRIFT), now)

    def note_received(self, here: float, server: float) -> None:
        """Notes that a value of the server's time ``server`` was received here at ``here``, so not later (both s)."""
        now, bound = time.monotonic(), here - server
        if self._upper is None or bound < self._at(self._upper, now, _DRIFT):
            self._upper = (bound, now)
        if self._lower is not None and bound < self._at(self._lower, now, -_DRIFT):
            self._lower = self._contradicted(bound, self._at(self._lower, now, -_DRIFT), now)

    def _contradicted(self, bound: float, old: float, now: float) -> tuple[float, float]:
        """Replaces an old bound that a new one contradicts: cycles were late or skipped, so that the offset is another one now."""
        self._contradiction = (max(abs(bound - old), self._jitter(now)), now)
        return bound, now

    def _jitter(self, now: float) -> float:
        """Returns the amount by which cycles were late, s; it is forgotten in the course of seconds."""
        amount, noted = self._contradiction
        return amount * math.exp((noted - now) / _MEMORY)

    @property
    def offset(self) -> float:
        """Time here minus time at the server, s. ``RuntimeError`` before the first message."""
        lower, upper = self._bounds()
        return (lower + upper) / 2

    @property
    def uncertainty(self) -> float:
        """Largest error of :attr:`offset`, with the lateness of recent cycles, s; infinite while only one bound is known. ``RuntimeError`` before the first message."""
        lower, upper = self._bounds()
        known = self._lower is not None and self._upper is not None
        return (upper - lower) / 2 + self._jitter(time.monotonic()) if known else math.inf

    def to_server(self, here: float) -> float:
        """Converts a time of ``time.monotonic()`` to the server's clock, s."""
        return here - self.offset

    def to_client(self, server: float) -> float:
        """Converts a time of the server's clock to that of ``time.monotonic()``, s."""
        return server + self.offset

    def _bounds(self) -> tuple[float, float]:
        now = time.monotonic()
        lower = None if self._lower is None else self._at(self._lower, now, -_DRIFT)
        upper = None if self._upper is None else self._at(self._upper, now, _DRIFT)
        one = lower if upper is None else upper
        if one is None:
            raise RuntimeError("the server has sent no time yet")
        return (one if lower is None else lower), one

    @staticmethod
    def _at(bound: tuple[float, float], now: float, drift: float) -> float:
        """Returns a bound as it holds now, looser by the drift since it was noted."""
        return bound[0] + drift * (now - bound[1])
