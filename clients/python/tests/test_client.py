"""Runs the client against a server: ``RPI=path/to/rpi python -m unittest discover -s tests`` in ``clients/python``.

``cargo test -p rpi --test python`` does the same, where there is a Python.
"""

import asyncio
import contextlib
import os
import shutil
import signal
import ssl
import subprocess
import tempfile
import time
import unittest
from typing import Any

from rpi_client import Goal, RpiError, connect

COUNT = """
command Count ()
let
  n = 1 -> pre n + 1;
  export n;
  finish done when n >= 300;
tel
"""

WATCHED = """
node Half (x: real) returns (y: real) let y = 0.5 * x; tel

command Main ()
let
  n = 0 -> pre n + 1;
  level = Half(real n);
  both = [n, 2 * n];
  finish done when n >= 300;
tel
"""

GAIN = """{in=Core::DoubleNetcommIn(Key='gain',Value='1.0'),
two=Core::DoubleMultiply(inFirst=in.outValue,Second='2.0'),
out=Core::DoubleNetcommOut(inValue=two.outValue,Key='twice')}"""


async def values_of(goal: Goal, flow: str) -> list[Any]:
    """Returns all values of a flow until its command has ended."""
    return [value async for value in goal.watch(flow)]


@unittest.skipUnless("RPI" in os.environ, "RPI does not name the server's program")
class ClientTest(unittest.IsolatedAsyncioTestCase):
    def setUp(self) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self.folder.name, "rpi.sock")
        self.serve("--socket", self.path)
        for _ in range(200):
            if os.path.exists(self.path):
                return
            time.sleep(0.02)

    def serve(self, *options: str) -> None:
        """Starts a server and notes where it listens."""
        command = [os.environ["RPI"], "serve", "--listen", "127.0.0.1:0", *options]
        self.server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert self.server.stderr is not None
        self.port = int(self.server.stderr.readline().rpartition(":")[2])

    def tearDown(self) -> None:
        self.stop()
        self.folder.cleanup()

    def stop(self) -> None:
        self.server.terminate()
        self.server.wait()
        assert self.server.stderr is not None
        self.server.stderr.close()

    async def test_what_json_cannot_say_is_refused_here(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            goal = await session.load(GAIN, language="rpinet")
            with self.assertRaises(ValueError):
                await goal.set(gain=float("nan"))
            await goal.set(gain=2.0)

    async def test_goal_feedback_result(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            first, second = [await session.load(COUNT, command="Count") for _ in range(2)]
            await second.follow(first, ["done"])
            await first.start()
            updates = [feedback async for feedback in second.feedback()]
            ending = await second.result()
            self.assertEqual((ending.result, ending.error, ending.cycles), ("done", 0, 300))
            self.assertEqual(updates[-1].values["n"], 300)
            self.assertEqual((await first.result()).result, "done")

    async def test_watched_flows_have_typed_values(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            goal = await session.load(WATCHED, watch=["Main"])
            flows = ("Main.level", "n", "Main.both", "both[1]")
            readers = [asyncio.create_task(values_of(goal, flow)) for flow in flows]
            await asyncio.sleep(0)
            await goal.start()
            level, counts, both, twice = [await asyncio.wait_for(reader, 30) for reader in readers]
            self.assertEqual((counts[-1], both[-1], twice[-1]), (300, [300, 600], 600))
            self.assertEqual(counts, sorted(counts))
            self.assertIsInstance(level[-1], float)
            ending = await goal.result()
            # The flows inside of the call stand beside its result.
            self.assertEqual(ending.values["level.y"], ending.values["level"])

    async def test_flows_that_are_not_watched_are_errors(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            goal = await session.load(WATCHED, watch=["Main.n"])
            with self.assertRaisesRegex(ValueError, "Main.level is not watched"):
                await values_of(goal, "Main.level")
            with self.assertRaises(RpiError) as refused:
                await session.load(WATCHED, watch=["Main.levle"])
            self.assertIn("did you mean `Main.level`", "".join([str(refused.exception), *refused.exception.reasons]))
            with self.assertRaises(RpiError):
                await session.load_task(WATCHED + "task All let Main(); tel", watch=["Main.levle"])

    async def test_inputs_and_abort(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test", on_loss="abort")
            goal = await session.load(GAIN, language="rpinet")
            await goal.start()
            await goal.set(gain=21.0)
            async for feedback in goal.feedback():
                if feedback.values.get("twice") == 42.0:
                    break
            await goal.abort()
            self.assertEqual((await asyncio.wait_for(goal.result(), 10)).cause, "aborted")

    async def test_branches_by_result(self) -> None:
        async with await connect(f"ws://127.0.0.1:{self.port}") as core:
            session = await core.open_session("test")
            turn = await session.load("command Turn () let finish left when time >= 50[ms]; finish right when false; tel")
            left, right = [await session.load(COUNT) for _ in range(2)]
            await left.follow(turn, ["left"])
            await right.follow(turn, ["right"])
            await turn.start()
            self.assertEqual((await left.result()).cycles, 300)
            self.assertEqual((await turn.result()).result, "left")
            with self.assertRaises(RpiError):
                await asyncio.wait_for(right.result(), 10)
            with self.assertRaises(RpiError):
                await core.call("command.describe", command=right.name)
            self.assertNotIn(right.name, core._listeners)

    async def test_a_task_is_carried_out(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            text = "command Wait (n: int) let finish over when time >= real(n) * 1[ms]; tel\n"
            text += "task All let parallel let Wait(20); tel let Wait(30); tel Wait(10); tel\n"
            task = await session.load_task(text, task="All")
            await task.start()
            end = await asyncio.wait_for(task.result(), 10)
            self.assertEqual((end.state, [result for _, result in end.commands]), ("done", ["over"] * 3))

    async def test_an_unloaded_task_is_updates(self) -> None:
        async with await connect(self.path) as core:
            task = await (await core.open_session("test")).load_task(COUNT + "task All let Count(); tel")
            waiting = asyncio.create_task(task.result())
            await task.unload()
            with self.assertRaisesRegex(RpiError, "unloaded"):
                await asyncio.wait_for(waiting, 10)
            self.assertNotIn(task.name, core._listeners)

    async def test_everybody_reads_feedback_to_its_end(self) -> None:
        async with await connect(self.path) as core:
            goal = await (await core.open_session("test")).load(COUNT)

            async def last() -> str:
                updates = [feedback async for feedback in goal.feedback()]
                return f"{updates[-1].state} {updates[-1].values['n']}"

            readers = [asyncio.create_task(last()) for _ in range(2)]
            await goal.start()
            self.assertEqual(await asyncio.wait_for(asyncio.gather(*readers), 10), ["terminated 300"] * 2)
            self.assertEqual(await asyncio.wait_for(last(), 10), "terminated 300")

    async def test_how_the_steps_of_a_task_have_ended(self) -> None:
        async with await connect(self.path) as core:
            task = await (await core.open_session("test")).load_task("command Wait () let finish over when time > 3600[s]; tel task All let Wait(); tel")
            await task.start()
            await asyncio.sleep(0.1)
            await core.emergency_stop("test")
            end = await asyncio.wait_for(task.result(), 10)
            (step,) = end.steps
            self.assertEqual((end.state, step.cause, step.why), ("failed", "aborted", "emergency stop"))

    async def test_an_emergency_stop_holds(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            running, ready = [await session.load(COUNT) for _ in range(2)]
            await running.start()
            await core.emergency_stop("test")
            self.assertEqual((await asyncio.wait_for(running.result(), 10)).why, "emergency stop")
            with self.assertRaises(RpiError):
                await ready.start()
            await core.reset_emergency()
            await ready.start()

    async def test_preempt_is_seen(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test", on_loss="run-on")
            goal = await session.load("command Wait () let finish stopped when cancel; finish never when false; tel")
            await goal.start()
            ending = await asyncio.wait_for(goal.preempt(), 10)
            self.assertEqual((ending.result, ending.cancelled), ("stopped", True))

    async def test_preempt_ends_what_ignores_it(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test", grace=0.05)
            goal = await session.load("command Deaf () let finish late when time > 1000[s]; tel")
            await goal.start()
            ending = await asyncio.wait_for(goal.preempt(), 10)
            self.assertEqual((ending.cause, ending.cancelled), ("aborted", True))

    async def test_the_operator_slows_and_pauses(self) -> None:
        async with await connect(self.path) as core:
            await core.set_override(0.5)
            await core.pause()
            self.assertEqual(await core.call("motion.state"), {"override": 0.5, "paused": True})
            await core.resume()
            with self.assertRaises(RpiError):
                await core.set_override(2.0)
            await core.set_override(1.0)

    async def test_a_lost_server_is_updates(self) -> None:
        core = await connect(f"ws://127.0.0.1:{self.port}")
        goal = await (await core.open_session("test")).load(COUNT)
        self.server.kill()
        with self.assertRaises(ConnectionError):
            await asyncio.wait_for(goal.result(), 10)
        with self.assertRaises(ConnectionError):
            await goal.start()
        await core.close()

    @unittest.skipUnless(shutil.which("openssl"), "there is no openssl to make a certificate")
    async def test_tls_and_token(self) -> None:
        self.stop()
        cert, key, token = [os.path.join(self.folder.name, name) for name in ("cert.pem", "key.pem", "token")]
        make = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
        about = ["-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"]
        subprocess.run([*make, *about, "-keyout", key, "-out", cert], check=True, capture_output=True)
        with open(token, "w", opener=lambda path, flags: os.open(path, flags, 0o600)) as file:
            file.write("secret-of-these-tests\n")
        os.chmod(key, 0o600)
        self.serve("--tls-cert", cert, "--tls-key", key, "--token-file", token)
        trust, address = ssl.create_default_context(cafile=cert), f"wss://localhost:{self.port}"
        with self.assertRaisesRegex(ConnectionError, "401 Unauthorized: the token is wrong"):
            await connect(address, token="wrong", tls=trust)
        with self.assertRaisesRegex(ConnectionError, "a token is needed"):
            await connect(address, tls=trust)
        with self.assertRaisesRegex(ConnectionError, "this port speaks TLS only"):
            await connect(f"ws://localhost:{self.port}", token="secret-of-these-tests")
        for bad in (f"http://localhost:{self.port}", f"tcp://localhost:{self.port}"):
            with self.assertRaises(ValueError):
                await connect(bad)
        with self.assertRaises(ssl.SSLError):
            await connect(address, token="secret-of-these-tests")
        async with await connect(address, token="secret-of-these-tests", tls=trust) as core:
            goal = await (await core.open_session("test")).load(COUNT)
            await goal.start()
            self.assertEqual((await goal.result()).cycles, 300)

    async def test_roles(self) -> None:
        self.stop()
        token = os.path.join(self.folder.name, "token")
        with open(token, "w", opener=lambda path, flags: os.open(path, flags, 0o600)) as file:
            file.write("panel viewer secret-of-the-panel\nanna operator secret-of-the-operator\n")
        self.serve("--token-file", token, "--socket", self.path)
        address = f"ws://localhost:{self.port}"
        async with await connect(address, token="secret-of-the-panel") as panel:
            identity = await panel.identity()
            self.assertEqual((identity.name, identity.role, identity.rights), ("panel", "viewer", ("stop", "watch")))
            with self.assertRaisesRegex(RpiError, "session.open needs the right to load") as caught:
                await panel.open_session("test")
            self.assertEqual(caught.exception.code, RpiError.FORBIDDEN)
            await panel.emergency_stop("the panel")
            with self.assertRaises(RpiError):
                await panel.reset_emergency()
        async with await connect(address, token="secret-of-the-operator") as anna:
            await anna.reset_emergency()
            self.server.send_signal(signal.SIGQUIT)
            while not (await anna.call("emergency.state"))["stopped"]:
                await asyncio.sleep(0.02)
            async with await connect(self.path) as programmer:
                with self.assertRaisesRegex(RpiError, "the operator requested the emergency stop"):
                    await programmer.reset_emergency()
            while (await anna.call("emergency.state"))["stopped"]:
                with contextlib.suppress(RpiError):
                    await anna.reset_emergency()

    async def test_every_reason_is_updates(self) -> None:
        async with await connect(self.path) as core:
            session = await core.open_session("test")
            with self.assertRaises(RpiError) as caught:
                await session.load("command X () let finish a when b; finish c when d; tel")
            self.assertGreaterEqual(len(caught.exception.reasons), 2)


if __name__ == "__main__":
    unittest.main()
