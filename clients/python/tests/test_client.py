"""Runs the client against a server: ``RPI=path/to/rpi python -m unittest discover -s tests`` in ``clients/python``."""

import asyncio
import os
import subprocess
import tempfile
import time
import unittest

from rpi_client import RpiError, connect

COUNT = """
command Count ()
let
  n = 1 -> pre n + 1;
  export n;
  finish done when n >= 300;
tel
"""

GAIN = """{in=Core::DoubleNetcommIn(Key='gain',Value='1.0'),
two=Core::DoubleMultiply(inFirst=in.outValue,Second='2.0'),
out=Core::DoubleNetcommOut(inValue=two.outValue,Key='twice')}"""


@unittest.skipUnless("RPI" in os.environ, "RPI does not name the server's program")
class ClientTest(unittest.IsolatedAsyncioTestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "rpi.sock")
        listen = ["--listen", "127.0.0.1:0", "--socket", self.path]
        self.server = subprocess.Popen([os.environ["RPI"], "serve", *listen])
        for _ in range(200):
            if os.path.exists(self.path):
                return
            time.sleep(0.02)

    def tearDown(self) -> None:
        self.server.terminate()
        self.server.wait()
        self.folder.cleanup()

    async def test_goal_feedback_result(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            first, second = [await session.load(COUNT, command="Count") for _ in range(2)]
            await second.follow(first, ["done"])
            await first.start()
            told = [feedback async for feedback in second.feedback()]
            ending = await second.result()
            self.assertEqual((ending.result, ending.error, ending.cycles), ("done", 0, 300))
            self.assertEqual(told[-1].values["n"], "300")
            self.assertEqual((await first.result()).result, "done")

    async def test_inputs_and_abort(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test", on_loss="abort")
            goal = await session.load(GAIN, language="rpinet")
            await goal.start()
            await goal.set(gain=21.0)
            async for feedback in goal.feedback():
                if feedback.values.get("twice", "").startswith("42"):
                    break
            await goal.abort()
            self.assertEqual((await asyncio.wait_for(goal.result(), 10)).cause, "aborted")

    async def test_every_reason_is_told(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            with self.assertRaises(RpiError) as caught:
                await session.load("command X () let finish a when b; finish c when d; tel")
            self.assertGreaterEqual(len(caught.exception.reasons), 2)


if __name__ == "__main__":
    unittest.main()
