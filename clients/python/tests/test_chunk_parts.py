"""The parts of a stream of chunks without a server: clocks, the mailbox, rows, the forms of policies, programs."""

from __future__ import annotations

import asyncio
import functools
import math
import random
import unittest
from collections.abc import AsyncIterator
from typing import Any
from unittest import mock

from rpi_client import Chunk, ChunkOptions, ChunkReport, Delays, Limit, Observation, Pose, ServerClock, Vector
from rpi_client._chunk import limit_of, padded, poses_of, rows_of
from rpi_client._chunk_program import chunk_program
from rpi_client._policy import Mailbox, chunks_of

from support import needs

ROWS = [[0.0] * 6] * 4


class ClockTest(unittest.TestCase):
    def test_the_offset_is_within_its_uncertainty(self) -> None:
        """For random delays of the messages, some of them long, and clocks that drift apart."""
        for seed in range(50):
            chance = random.Random(seed)
            offset, drift, now = chance.uniform(-1e4, 1e4), chance.uniform(-4e-4, 4e-4), 100.0
            clock = ServerClock()
            with mock.patch("rpi_client._clock.time.monotonic", lambda: now):
                for _ in range(200):
                    now += chance.expovariate(50)
                    delay = chance.expovariate(1000) + (chance.random() < 0.1) * 0.3
                    true = offset + drift * now
                    if chance.random() < 0.5:
                        clock.note_sent(now - delay, now - true)
                    else:
                        clock.note_received(now, now - delay - true)
                    self.assertLessEqual(abs(clock.offset - true), clock.uncertainty + 4e-4 + 1e-9, f"seed {seed}")
                self.assertLess(clock.uncertainty, 0.02)

    def test_skipped_cycles_are_followed(self) -> None:
        """The clock of a command counts cycles: it falls behind if the server skips some, or runs ahead for the reader of an old bound."""
        for jump in (0.5, -0.5):
            clock, now = ServerClock(), 10.0
            with mock.patch("rpi_client._clock.time.monotonic", lambda: now):
                for k in range(100):
                    now += 0.01
                    offset = 3.0 + jump * (k >= 50)
                    clock.note_sent(now - 0.001, now - offset)
                    clock.note_received(now, now - 0.001 - offset)
                self.assertAlmostEqual(clock.offset, offset, delta=0.002)

    def test_one_bound_is_an_estimate(self) -> None:
        clock = ServerClock()
        with self.assertRaisesRegex(RuntimeError, "no time yet"):
            clock.to_client(0.0)
        clock.note_sent(5.0, 0.0)
        self.assertAlmostEqual(clock.to_client(1.0), 6.0, delta=0.1)
        self.assertEqual(clock.uncertainty, math.inf)


class RowsTest(unittest.TestCase):
    def test_rows_of_a_wrong_form_are_errors(self) -> None:
        cases: list[tuple[Any, type[Exception], str]] = [
            (ROWS[:3], ValueError, "4 to 50 rows are needed, and there are 3"),
            ([[0.0] * 6] * 51, ValueError, "there are 51"),
            ([*ROWS, [0.0] * 7], ValueError, "a row of 6 numbers"),
            ([*ROWS, 1.0], TypeError, "not a row of numbers"),
            ("rows", TypeError, "not a sequence of rows"),
            ([["0.0"] * 6] * 4, TypeError, "'0.0' is not a number"),
            ([[True] * 6] * 4, TypeError, "True is not a number"),
        ]
        for rows, kind, message in cases:
            with self.subTest(message=message), self.assertRaisesRegex(kind, "positions: .*" + message):
                rows_of("positions", rows, 6, 50)

    def test_short_chunks_repeat_their_last_row(self) -> None:
        rows = rows_of("positions", [[k, -k] for k in range(4)], 2, 6)
        self.assertEqual(padded(rows, 6), [0.0, 0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 3.0, -3.0, 3.0, -3.0])

    @needs("numpy")
    def test_arrays_are_rows(self) -> None:
        import numpy as np

        self.assertEqual(rows_of("positions", np.arange(8.0).reshape(4, 2), 2, 4), [[0, 1], [2, 3], [4, 5], [6, 7]])
        self.assertEqual(rows_of("positions", [np.float32(k) * np.ones(1) for k in range(4)], 1, 4), [[0], [1], [2], [3]])

    def test_poses_are_rows_of_seven_numbers(self) -> None:
        pose = Pose(Vector(1, 2, 3))
        self.assertEqual(rows_of("poses", [pose] * 4, 7, 4), [[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0]] * 4)
        self.assertEqual(poses_of([[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0]]), [pose])
        with self.assertRaisesRegex(ValueError, "a row of 6 numbers"):
            rows_of("positions", [pose] * 4, 6, 4)

    def test_limits_have_names(self) -> None:
        self.assertEqual([limit_of(*pair) for pair in ((0, 0), (3, 2), (1, 9))], [None, Limit(2, "acceleration"), None])
        report = ChunkReport()
        for limit in (None, Limit(2, "jerk"), Limit(2, "jerk"), Limit(0, "range")):
            report.note(limit, 0.25, 0.5)
        self.assertIn("limits that bound: jerk of joint 2 in 50.0 %, range of joint 0 in 25.0 %", str(report))
        self.assertIn("deviation: 0.2500 rad at most, by smoothing 0.5000 rad", str(report))

    def test_quantiles(self) -> None:
        delays = Delays()
        self.assertTrue(math.isnan(delays.p99))
        for k in range(20_000):
            delays.add(k / 20_000)
        self.assertEqual((delays.count, delays.most, delays.median), (20_000, 0.99995, 0.74995))
        self.assertEqual(delays.p99, sorted(k / 20_000 for k in range(10_000, 20_000))[9_899])

    def test_options_out_of_range_are_errors(self) -> None:
        types = {"arm": ("motion", "Arm<<6>>")}
        for wrong in (ChunkOptions(rows=3), ChunkOptions(period=0.2), ChunkOptions(previous=1.0), ChunkOptions(smoothing=math.nan)):
            with self.subTest(options=wrong), self.assertRaisesRegex(ValueError, "not from"):
                chunk_program("arm", 6, types, wrong)
        with self.assertRaisesRegex(ValueError, "speed is -1.0, not a positive number"):
            chunk_program("arm", 6, types, ChunkOptions(speed=-1.0))
        for injected in (ChunkOptions(observe=["pose; finish x when true"]), ChunkOptions(gripper="h; x = 1"), ChunkOptions(channels={"arm.b; x": ""})):
            with self.assertRaisesRegex(ValueError, "not a name in programs"):
                chunk_program("arm", 6, types, injected)
        with self.assertRaisesRegex(ValueError, "no device hand"):
            chunk_program("arm", 6, types, ChunkOptions(gripper="hand"))


async def observations(count: int = 3) -> AsyncIterator[Observation]:
    for k in range(count):
        yield Observation(k + 1, 0.1 * k, 0.1 * k)


class PolicyTest(unittest.IsolatedAsyncioTestCase):
    async def test_the_forms_of_a_policy(self) -> None:
        closed = []

        def plain(observation: Observation) -> Chunk | None:
            return Chunk(ROWS) if observation.number < 3 else None

        async def coroutine(observation: Observation) -> Chunk | None:
            await asyncio.sleep(0)
            return plain(observation)

        class Callable:
            async def __call__(self, observation: Observation) -> Chunk | None:
                return plain(observation)

        async def generator(seen: AsyncIterator[Observation]) -> AsyncIterator[Chunk]:
            try:
                async for observation in seen:
                    if (chunk := plain(observation)) is not None:
                        yield chunk
            finally:
                closed.append("generator")

        async def iterator() -> AsyncIterator[Chunk]:
            for _ in range(2):
                yield Chunk(ROWS)

        forms: list[Any] = [plain, coroutine, Callable(), generator, iterator(), functools.partial(coroutine), lambda seen: coroutine(seen)]
        for policy in forms:
            with self.subTest(policy=policy):
                chunks = [chunk async for chunk in chunks_of(policy, observations())]
                self.assertEqual(chunks, [Chunk(ROWS)] * 2)
        self.assertEqual(closed, ["generator"])
        with self.assertRaisesRegex(TypeError, "neither a function"):
            [chunk async for chunk in chunks_of(ROWS, observations())]  # type: ignore[arg-type]

    async def test_the_latest_chunk_wins(self) -> None:
        mailbox = Mailbox("latest", 4)
        for k in range(5):
            await mailbox.put(Chunk(ROWS, float(k)))
        closing = asyncio.create_task(mailbox.close())
        self.assertEqual([chunk.observed async for chunk in mailbox.chunks()], [4.0])
        await closing
        self.assertEqual(mailbox.dropped, 4)
        with self.assertRaisesRegex(ValueError, "needs backlog='queue'"):
            await mailbox.put(Chunk(ROWS, append=True))

    async def test_a_queue_makes_the_policy_wait(self) -> None:
        mailbox = Mailbox("queue", 2)

        async def produce() -> None:
            for k in range(6):
                await mailbox.put(Chunk(ROWS, float(k), append=k > 0))
                produced.append(k)
            await mailbox.close()

        produced: list[int] = []
        producer = asyncio.create_task(produce())
        for _ in range(10):
            await asyncio.sleep(0)
        self.assertEqual(produced, [0, 1])
        self.assertEqual([chunk.observed async for chunk in mailbox.chunks()], [0.0, 1.0, 2.0, 3.0, 4.0, 5.0])
        await producer
        self.assertEqual(mailbox.dropped, 0)
        for wrong in (("newest", 1), ("queue", 0)):
            with self.assertRaises(ValueError):
                Mailbox(*wrong)  # type: ignore[arg-type]


if __name__ == "__main__":
    unittest.main()
