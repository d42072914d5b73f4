"""Server of the real-time data exchange (RTDE), version 2, and of the port for programs.

Written from the published "Real-Time Data Exchange (RTDE) Guide" of Universal Robots. All numbers are big-endian.
"""

import socket
import struct

from urscript import is_complete

MOST_BYTES = 65536

# Variables that a client may read: type, and value of a robot.
OUTPUTS = {
    "timestamp": ("DOUBLE", lambda robot: robot.clock),
    "target_q": ("VECTOR6D", lambda robot: robot.target),
    "target_qd": ("VECTOR6D", lambda robot: robot.velocity),
    "actual_q": ("VECTOR6D", lambda robot: robot.position),
    "actual_qd": ("VECTOR6D", lambda robot: robot.velocity),
    "robot_mode": ("INT32", lambda robot: robot.robot_mode),
    "safety_mode": ("INT32", lambda robot: robot.safety_mode),
    "safety_status": ("INT32", lambda robot: robot.safety_mode),
    "runtime_state": ("UINT32", lambda robot: robot.runtime_state),
    # Bits: power on, program running. Bits: normal, reduced, protective stop, ..., robot emergency stop, any one.
    "robot_status_bits": ("UINT32", lambda robot: (robot.robot_mode == 7) | (robot.runtime_state == 2) << 1),
    "safety_status_bits": (
        "UINT32",
        lambda robot: {1: 0b1, 3: 0b100, 7: 0b11000000}.get(robot.safety_mode, 0),
    ),
    "speed_scaling": ("DOUBLE", lambda robot: 1.0),
    "target_speed_fraction": ("DOUBLE", lambda robot: robot.scaling),
}
FORMATS = {"DOUBLE": "d", "VECTOR6D": "6d", "INT32": "i", "UINT32": "I"}


def register(kind, number, store):
    values = lambda robot: getattr(robot, store)[kind]
    return lambda robot: values(robot)[number]


for _number in range(48):
    for _kind, _type in (("int", "INT32"), ("double", "DOUBLE")):
        OUTPUTS[f"output_{_kind}_register_{_number}"] = (_type, register(_kind, _number, "outputs"))
        OUTPUTS[f"input_{_kind}_register_{_number}"] = (_type, register(_kind, _number, "inputs"))

# Variables that a client may write: type, and place in the registers.
INPUTS = {
    f"input_{kind}_register_{number}": (type_name, (kind, number))
    for number in range(48)
    for kind, type_name in (("int", "INT32"), ("double", "DOUBLE"))
}


def names_of(payload):
    """Returns the names of a list. Some clients end it with a comma, which a controller accepts."""
    return payload.decode().rstrip(",").split(",")


class Client:
    """Connection of one RTDE client."""

    def __init__(self, stream):
        self.stream = stream
        self.stream.setblocking(False)
        self.stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.received = b""
        self.unsent = b""
        self.is_started = False
        self.outputs = []
        self.format = struct.Struct(">")
        # Number of cycles between two packages.
        self.divisor = 1
        self.inputs = {}

    def send(self, kind, payload):
        self.unsent += struct.pack(">HB", len(payload) + 3, ord(kind)) + payload
        if len(self.unsent) > MOST_BYTES:
            raise ConnectionError("the client does not read")
        self.flush()

    def flush(self):
        if self.unsent:
            try:
                self.unsent = self.unsent[self.stream.send(self.unsent) :]
            except BlockingIOError:
                pass

    def packages(self):
        """Returns the complete packages that have come."""
        try:
            new = self.stream.recv(MOST_BYTES)
            if not new:
                raise ConnectionError("closed")
            self.received += new
        except BlockingIOError:
            pass
        found = []
        while len(self.received) >= 3:
            size, kind = struct.unpack_from(">HB", self.received)
            if size < 3:
                raise ConnectionError("a package is too short")
            if len(self.received) < size:
                break
            found.append((chr(kind), self.received[3:size]))
            self.received = self.received[size:]
        return found


class RtdeServer:
    """All RTDE clients of a robot."""

    def __init__(self, robot, port, version):
        self.robot = robot
        self.version = version
        self.listener = listen(port)
        self.clients = []
        # Variables that a client writes, so that another one must not.
        self.owners = {}

    @property
    def port(self):
        return self.listener.getsockname()[1]

    def drop_all(self):
        for client in list(self.clients):
            self.drop(client)

    def drop(self, client):
        client.stream.close()
        self.clients.remove(client)
        self.owners = {name: owner for name, owner in self.owners.items() if owner is not client}

    def receive(self, is_lost):
        """Handles new clients and requests. `is_lost` decides for each data package whether it is lost."""
        try:
            self.clients.append(Client(self.listener.accept()[0]))
        except BlockingIOError:
            pass
        for client in list(self.clients):
            try:
                for kind, payload in client.packages():
                    if kind != "U" or not is_lost():
                        self.handle(client, kind, payload)
                client.flush()
            except (OSError, struct.error, UnicodeDecodeError):
                self.drop(client)

    def handle(self, client, kind, payload):
        if kind == "V":
            client.send("V", bytes([struct.unpack(">H", payload)[0] == 2]))
        elif kind == "v":
            client.send("v", struct.pack(">4I", *self.version))
        elif kind == "O":
            self.set_up_outputs(client, payload)
        elif kind == "I":
            self.set_up_inputs(client, payload)
        elif kind == "S":
            client.is_started = bool(client.outputs)
            client.send("S", bytes([client.is_started]))
        elif kind == "P":
            client.is_started = False
            client.send("P", b"\1")
        elif kind == "U":
            self.take_inputs(client, payload)
        else:
            text = f"unknown package {kind}".encode()
            client.send("M", bytes([len(text)]) + text + bytes([4]) + b"RTDE" + bytes([1]))

    def set_up_outputs(self, client, payload):
        (frequency,) = struct.unpack_from(">d", payload)
        names = names_of(payload[8:])
        types = [OUTPUTS[name][0] if name in OUTPUTS else "NOT_FOUND" for name in names]
        is_valid = "NOT_FOUND" not in types and 1 <= frequency <= 1 / self.robot.cycle
        if is_valid:
            client.outputs = [OUTPUTS[name] for name in names]
            client.format = struct.Struct(">B" + "".join(FORMATS[name] for name in types))
            client.divisor = max(1, round(1 / self.robot.cycle / frequency))
        client.send("O", bytes([is_valid]) + ",".join(types).encode())

    def set_up_inputs(self, client, payload):
        names = names_of(payload)
        types = [INPUTS[name][0] if name in INPUTS else "NOT_FOUND" for name in names]
        used = [self.owners.get(name, client) is not client for name in names]
        types = ["IN_USE" if other else type_name for type_name, other in zip(types, used)]
        is_valid = "NOT_FOUND" not in types and "IN_USE" not in types
        number = len(client.inputs) + 1 if is_valid else 0
        if is_valid:
            self.owners.update((name, client) for name in names)
            layout = struct.Struct(">" + "".join(FORMATS[name] for name in types))
            client.inputs[number] = (layout, [INPUTS[name][1] for name in names])
        client.send("I", bytes([number]) + ",".join(types).encode())

    def take_inputs(self, client, payload):
        layout, places = client.inputs[payload[0]] if payload[0] in client.inputs else (None, [])
        if layout:
            for (kind, number), value in zip(places, layout.unpack(payload[1:])):
                self.robot.inputs[kind][number] = value

    def send_states(self, is_lost):
        for client in list(self.clients):
            if not client.is_started or self.robot.cycles % client.divisor or is_lost():
                continue
            values = []
            for _, value in client.outputs:
                now = value(self.robot)
                values.extend(now if isinstance(now, list) else [now])
            try:
                client.send("U", client.format.pack(1, *values))
            except OSError:
                self.drop(client)


class ProgramServer:
    """Port that accepts URScript programs. A real one also sends states of the robot, which its clients skip."""

    def __init__(self, robot, port):
        self.robot = robot
        self.listener = listen(port)
        self.clients = []

    @property
    def port(self):
        return self.listener.getsockname()[1]

    def receive(self):
        try:
            stream = self.listener.accept()[0]
            stream.setblocking(False)
            self.clients.append([stream, b""])
        except BlockingIOError:
            pass
        for client in list(self.clients):
            stream, text = client
            try:
                if self.robot.cycles % 50 == 0:
                    # Message of the kind 16 (state of the robot) without parts.
                    stream.send(struct.pack(">IB", 5, 16))
                new = stream.recv(MOST_BYTES)
            except BlockingIOError:
                continue
            except OSError:
                new = b""
            client[1] = text = text + new
            if not new or len(text) > MOST_BYTES:
                stream.close()
                self.clients.remove(client)
            elif is_complete(text.decode(errors="replace")):
                self.robot.start(text.decode(errors="replace"))
                client[1] = b""


def listen(port):
    listener = socket.create_server(("127.0.0.1", port))
    listener.setblocking(False)
    return listener
