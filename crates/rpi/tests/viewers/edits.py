"""Decodes every message of a part of a recording (profile ros2) and of two merged recordings.

Usage: edits.py WHOLE PART MERGED. Needs the packages mcap and mcap-ros2-support.
"""

import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def read(file):
    """Decodes all messages. Returns them by topic, each with its time, and the names of the metadata and attachments."""
    topics = {}
    with open(file, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()], validate_crcs=True)
        summary = reader.get_summary()
        assert summary.statistics.channel_count == len(summary.channels)
        for _, channel, message, decoded in reader.iter_decoded_messages():
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
        names = {metadata.name for metadata in reader.iter_metadata()}
        names |= {attachment.name for attachment in reader.iter_attachments()}
    return topics, names


whole, _ = read(sys.argv[1])
part, names = read(sys.argv[2])
assert {"rpi", "rpi-end", "cell.toml"} <= names, names
start, end = part["/joint_states"][0][0], part["/joint_states"][-1][0]
assert len(part["/robot_description"]) == 1 and part["/robot_description"][0][0] == start
for topic in ("/joint_states", "/tf", "/set_points/arm", "/device/arm"):
    kept = [str(message) for time, message in whole[topic] if start <= time <= end]
    assert kept == [str(message) for _, message in part[topic]], topic

merged, names = read(sys.argv[3])
assert any(name.endswith("/cell.toml") for name in names), names
for source, prefix in ((whole, "/out"), (part, "/part")):
    for topic, messages in source.items():
        if not topic.startswith("/rpi/"):
            # A topic that only one of them has keeps its name.
            name = prefix + topic if topic in whole and topic in part else topic
            assert [t for t, _ in merged[name]] == [t for t, _ in messages], name
print(f"decoded {sum(map(len, part.values()))} and {sum(map(len, merged.values()))} messages")
