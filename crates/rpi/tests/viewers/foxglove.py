"""Subscribes to live joint states and to flows of a command, by the published protocol of Foxglove.

Usage: foxglove.py URL COMMAND_TOPIC FLOW. FLOW is the path of a number in the messages of the topic, such as way.speed. Needs the
package websockets.
"""

import asyncio
import json
import struct
import sys

import websockets

PROTOCOL = "foxglove.websocket.v1"
MESSAGE_DATA = 1


async def receive(socket, channels):
    """The next data: subscription, time in ns and message. Keeps the channels by topic up to date."""
    while True:
        message = await asyncio.wait_for(socket.recv(), 60)
        if isinstance(message, bytes):
            opcode, subscription, time = struct.unpack_from("<BIQ", message)
            assert opcode == MESSAGE_DATA, opcode
            return subscription, time, json.loads(message[13:])
        message = json.loads(message)
        if message["op"] == "advertise":
            channels.update((channel["topic"], channel) for channel in message["channels"])
        elif message["op"] == "unadvertise":
            # The command has ended; its topic comes back, as another channel, when it is loaded again.
            for topic in [t for t, channel in channels.items() if channel["id"] in message["channelIds"]]:
                del channels[topic]
        elif message["op"] == "status":
            assert message["level"] < 2, message


async def main(url, topic, flow):
    async with websockets.connect(url, subprotocols=["other.v9", PROTOCOL], max_size=None) as socket:
        assert socket.subprotocol == PROTOCOL
        info = json.loads(await asyncio.wait_for(socket.recv(), 60))
        assert info["op"] == "serverInfo" and info["name"].startswith("rpi "), info
        channels, schemas, wanted, got = {}, {}, {0: "/joint_states", 1: topic}, {0: [], 1: []}
        subscribed = {}
        advertised = json.loads(await asyncio.wait_for(socket.recv(), 60))
        assert advertised["op"] == "advertise", advertised
        channels.update((channel["topic"], channel) for channel in advertised["channels"])
        # The topics of the command appear when it is loaded; messages of the first subscription bring them here.
        while any(len(messages) < 100 for messages in got.values()):
            for subscription, name in wanted.items():
                channel = channels.get(name, {}).get("id")
                if channel is not None and subscribed.get(subscription) != channel:
                    subscribed[subscription] = channel
                    request = {"id": subscription, "channelId": channel}
                    await socket.send(json.dumps({"op": "subscribe", "subscriptions": [request]}))
                    schemas[name] = channels[name]["schema"]
            subscription, time, message = await receive(socket, channels)
            got[subscription].append((time, message))
    for messages in got.values():
        times = [time for time, _ in messages]
        assert times == sorted(times) and times[0] < times[-1]
    joints = got[0][-1][1]["joints"]
    assert [joint["name"] for joint in joints[:2]] == ["arm_joint_1", "arm_joint_2"], joints
    schema = json.loads(schemas[topic])
    for name in flow.split("."):
        schema = schema["properties"][name]
    assert schema["type"] == "number", schema
    values = []
    for _, message in got[1]:
        for name in flow.split("."):
            message = message[name]
        values.append(message)
    assert all(isinstance(value, (int, float)) for value in values), values
    print(f"{len(got[0])} joint states, {len(values)} values of {flow}, the last one {values[-1]}")


asyncio.run(main(*sys.argv[1:]))
