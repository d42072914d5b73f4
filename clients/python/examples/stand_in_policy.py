"""A policy that drives an arm by chunks of joint positions: a stand-in that computes for a random time.

    rpi serve --cell cell.toml --socket rpi.sock
    python stand_in_policy.py rpi.sock --seconds 10 --frames frames.parquet

It waves two joints, each chunk 1 s long. Put the inference of your own policy in the place of `StandIn.__call__`.
"""

from __future__ import annotations

import argparse
import asyncio
import math
import random
import time

from rpi_client import Arm, Chunk, ChunkOptions, ChunkReport, FrameTable, Observation, connect

OPTIONS = ChunkOptions(rows=50, period=0.02, previous=0.3)


class StandIn:
    """A policy: it returns a chunk that begins at the time of the observation, after 20 to `delay` seconds, and None in the end."""

    def __init__(self, seconds: float, delay: float, seed: int) -> None:
        self.seconds = seconds
        self.delay = delay
        self.random = random.Random(seed)
        self.home: list[float] = []

    def __call__(self, observation: Observation) -> Chunk | None:
        self.home = self.home or observation.commanded
        time.sleep(self.random.uniform(0.02, self.delay))
        if observation.server_time > self.seconds:
            return None
        times = [observation.server_time + k * OPTIONS.period for k in range(OPTIONS.rows)]
        return Chunk([self.wanted(t) for t in times])

    def wanted(self, t: float) -> list[float]:
        """Returns the joint positions (rad) that the policy wants at a time (s)."""
        # It begins gently, from the pose in which the arm rests.
        size = 0.3 * (1 - math.exp(-(t**2)))
        wave = size * math.sin(2 * t)
        return [position + wave * (k in (0, 2)) for k, position in enumerate(self.home)]


async def run(address: str, policy: StandIn, frames: FrameTable | None) -> ChunkReport:
    """Lets the policy move the first arm of the cell."""
    async with await connect(address) as core, await core.open_session("policy") as session:
        devices = (await session.devices()).values()
        arm = next(device for device in devices if isinstance(device, Arm))
        return await arm.chunks(policy, OPTIONS, frames=frames)


def main() -> None:
    parser = argparse.ArgumentParser(description="Drives an arm by a stand-in for a policy.")
    parser.add_argument("address", help="socket or ws://host:port of the server")
    parser.add_argument("--seconds", type=float, default=10.0, help="duration of the motion")
    parser.add_argument("--delay", type=float, default=0.3, help="longest time of an inference, s")
    parser.add_argument("--seed", type=int, default=1, help="seed of the delays")
    parser.add_argument("--frames", help="Parquet file for observations and actions")
    options = parser.parse_args()
    policy = StandIn(options.seconds, options.delay, options.seed)
    if options.frames is None:
        report = asyncio.run(run(options.address, policy, None))
    else:
        with FrameTable(options.frames) as frames:
            report = asyncio.run(run(options.address, policy, frames))
    print(report)
    if report.ending is not None:
        print(f"ended with {report.ending.result}")


if __name__ == "__main__":
    main()
