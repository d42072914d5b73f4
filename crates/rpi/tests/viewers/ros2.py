"""Decodes every message of a recording with the profile ros2, and compares joint states, transforms and device samples.

Usage: ros2.py FILE. Needs the packages mcap and mcap-ros2-support; uses rerun-sdk if it is installed.
"""

import math
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

CYCLE = 1_000_000


def rotate(q, v):
    """Rotates the vector v by the quaternion q = (x, y, z, w)."""
    x, y, z, w = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [
        v[0] + w * t[0] + y * t[2] - z * t[1],
        v[1] + w * t[1] + z * t[0] - x * t[2],
        v[2] + w * t[2] + x * t[1] - y * t[0],
    ]


def tool_position(transforms, device):
    """Position of the tool of a device in the world, from the transforms of one message."""
    parents = {t.child_frame_id: t for t in transforms}
    point, frame = [0.0, 0.0, 0.0], f"{device}_tool"
    while frame != "world":
        t = parents[frame].transform
        turned = rotate((t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w), point)
        shift = (t.translation.x, t.translation.y, t.translation.z)
        point = [a + b for a, b in zip(turned, shift)]
        frame = parents[frame].header.frame_id
    return point


def described_position(urdf, joints, device):
    """Position of the tool in the world, by the robot description and the positions of the joints."""
    root = ElementTree.fromstring(urdf)
    parents = {j.find("child").get("link"): j for j in root.findall("joint")}
    point, frame = [0.0, 0.0, 0.0], f"{device}_tool"
    while frame != "world":
        joint = parents[frame]
        axis = joint.find("axis")
        if axis is not None:
            axis = [float(a) for a in axis.get("xyz").split()]
            half = joints[joint.get("name")] / 2
            point = rotate([*(a * math.sin(half) for a in axis), math.cos(half)], point)
        origin = joint.find("origin")
        roll, pitch, yaw = (float(a) for a in origin.get("rpy").split())
        for axis, angle in (((1, 0, 0), roll), ((0, 1, 0), pitch), ((0, 0, 1), yaw)):
            turn = [*(a * math.sin(angle / 2) for a in axis), math.cos(angle / 2)]
            point = rotate(turn, point)
        point = [a + float(b) for a, b in zip(point, origin.get("xyz").split())]
        frame = joint.find("parent").get("link")
    return point


def read(file):
    """Decodes all messages. Returns them by topic, each with its time in nanoseconds."""
    topics = {}
    with open(file, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()], validate_crcs=True)
        for _, channel, message, decoded in reader.iter_decoded_messages():
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
    return topics


def check(topics):
    device = {message.cycle: message for _, message in topics["/device/arm"]}
    times = [time for time, _ in topics["/joint_states"]]
    assert all(b - a == CYCLE for a, b in zip(times, times[1:])), "a joint state in each cycle"
    urdf = topics["/robot_description"][0][1].data
    tools = {message.header.stamp.sec * 10**9 + message.header.stamp.nanosec: message
             for _, message in topics["/device/arm"]}
    states = {time: message for time, message in topics["/joint_states"]}
    for (time, state), sample in zip(topics["/joint_states"], device.values()):
        assert list(state.position) == list(sample.joint_commanded_position), time
    assert len(topics["/tf"]) > 50
    for time, message in topics["/tf"]:
        tcp = tools[time].tcp_commanded_position.position
        joints = dict(zip(states[time].name, states[time].position))
        for point in (tool_position(message.transforms, "arm"), described_position(urdf, joints, "arm")):
            error = math.dist(point, (tcp.x, tcp.y, tcp.z))
            assert error < 1e-9, f"the tool is {error} m beside its place at {time}"
    for topic in ("/rosout", "/diagnostics", "/set_points/arm", "/events"):
        assert topics[topic], topic
    assert any(topic.startswith("/rpi/") for topic in topics), "the log of ticks"


def check_rerun(file):
    """Loads the recording with Rerun, if it is installed. Returns what was done."""
    try:
        import rerun
    except ImportError:
        return "rerun-sdk is not installed"
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.rrd"
        stream = rerun.RecordingStream("rpi")
        stream.save(out)
        stream.log_file_from_path(file)
        stream.flush()
        tool = Path(sys.executable).with_name("rerun")
        shown = subprocess.run([tool, "rrd", "print", out], capture_output=True, text=True, check=True)
    for part in (r"/tf\S* - data columns: \[Transform3D", r"/joint_states\S* - data columns: \[Scalars"):
        assert re.search(part, shown.stdout), f"Rerun does not show {part}"
    return "Rerun shows transforms and joint values"


topics = read(sys.argv[1])
check(topics)
print(f"decoded {sum(map(len, topics.values()))} messages on {len(topics)} topics; {check_rerun(sys.argv[1])}")
