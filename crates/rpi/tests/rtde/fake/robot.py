"""Robot with six axes: a servo with limits of velocity and acceleration, the states of the robot, and its trace."""

import math
from array import array

from urscript import Program, ScriptError

AXES = 6

# Values of `robot_mode`, `safety_mode` and `runtime_state`.
POWER_OFF, RUNNING = 3, 7
NORMAL, PROTECTIVE_STOP, ROBOT_EMERGENCY_STOP = 1, 3, 7
STOPPING, STOPPED, PLAYING, PAUSED = 0, 1, 2, 4


class Robot:
    """The robot and its program, from cycle to cycle."""

    # Limits of the servo, above those of the arm models, so that the trace shows excesses of set-points.
    VELOCITY = 2.0 * math.pi
    ACCELERATION = 40.0
    # Deceleration of stops that the controller does itself.
    SAFE_STOP = 20.0

    def __init__(self, joints, cycle):
        self.cycle = cycle
        self.cycles = 0
        self.position = list(joints)
        self.velocity = [0.0] * AXES
        self.target = list(joints)
        self.robot_mode, self.safety_mode, self.runtime_state = RUNNING, NORMAL, STOPPED
        self.inputs = {"int": [0] * 48, "double": [0.0] * 48}
        self.outputs = {"int": [0] * 48, "double": [0.0] * 48}
        # Share of the full speed that the operator has set.
        self.scaling = 1.0
        self.program = None
        # Set-point, lookahead time and gain of `servoj` in this cycle; None without one.
        self.servo = None
        self.deceleration = self.SAFE_STOP
        self.trace = array("d")
        self.log = []

    @property
    def clock(self):
        return self.cycles * self.cycle

    def speed(self):
        return max(abs(velocity) for velocity in self.velocity)

    def note(self, text):
        self.log.append(text)

    # Programs.

    def start(self, text):
        """Starts a program, which replaces the running one."""
        if self.safety_mode != NORMAL or self.robot_mode != RUNNING:
            return self.note("REJECTED a program, because the robot is not running")
        try:
            self.program = Program(text, self.builtins())
        except (ScriptError, SyntaxError) as error:
            return self.note(f"ERROR in a program: {error}")
        self.runtime_state = PLAYING
        self.note(f"PROGRAM {self.program.name}")

    def end_program(self, why):
        if self.program or self.runtime_state == PAUSED:
            self.note(f"PROGRAM ended: {why}")
        self.program, self.servo = None, None
        self.runtime_state = STOPPED
        self.deceleration = self.SAFE_STOP

    def builtins(self):
        def read(kind):
            return lambda register: self.inputs[kind][register]

        def write(kind):
            def store(register, value):
                self.outputs[kind][register] = value

            return store

        def norm(value):
            return math.sqrt(sum(x * x for x in value)) if isinstance(value, list) else abs(value)

        return {
            "norm": norm,
            "floor": math.floor,
            "sqrt": math.sqrt,
            "get_steptime": lambda: self.cycle,
            "get_actual_joint_positions": lambda: list(self.position),
            "get_actual_joint_speeds": lambda: list(self.velocity),
            "get_target_joint_positions": lambda: list(self.target),
            "read_input_integer_register": read("int"),
            "read_input_float_register": read("double"),
            "write_output_integer_register": write("int"),
            "write_output_float_register": write("double"),
            "textmsg": lambda *texts: self.note("MESSAGE " + "".join(map(str, texts))),
            "servoj": self.servoj,
            "stopj": self.stopj,
            "sync": self.sync,
            "sleep": self.sleep,
        }

    def servoj(self, q, a, v, t=0.002, lookahead_time=0.1, gain=300):
        if not (isinstance(q, list) and len(q) == AXES and all(math.isfinite(x) for x in q)):
            raise ScriptError("servoj: q is not a list of six numbers")
        if not (0.03 <= lookahead_time <= 0.2 and 100 <= gain <= 2000):
            raise ScriptError("servoj: lookahead_time or gain out of range")
        self.servo = (list(q), lookahead_time)
        for _ in range(max(1, round(t / self.cycle / self.scaling))):
            yield

    def stopj(self, a):
        self.servo, self.deceleration = None, a
        while self.speed() > 0.0:
            yield

    def sync(self):
        # In a thread, it does not end the motion.
        if not self.program.is_in_thread:
            self.servo = None
        yield

    def sleep(self, t):
        self.servo = None
        for _ in range(max(1, round(t / self.cycle))):
            yield

    # Faults and the operator.

    def protective_stop(self):
        self.safety_mode = PROTECTIVE_STOP
        self.end_program("protective stop")

    def protective_pause(self):
        """A protective stop that leaves the program paused."""
        self.safety_mode, self.runtime_state, self.servo = PROTECTIVE_STOP, PAUSED, None
        self.deceleration = self.SAFE_STOP

    def emergency_stop(self):
        self.safety_mode = ROBOT_EMERGENCY_STOP
        self.end_program("emergency stop")

    def unlock(self):
        self.safety_mode, self.robot_mode = NORMAL, RUNNING
        if self.runtime_state == PAUSED:
            self.runtime_state = PLAYING

    # The cycle.

    def step(self):
        self.cycles += 1
        if self.program and self.runtime_state == PLAYING:
            try:
                if not self.program.resume():
                    self.end_program("its end")
            except (ScriptError, TypeError, ZeroDivisionError, IndexError) as error:
                self.end_program(f"ERROR {error}")
        if self.servo:
            self.follow(*self.servo)
        else:
            self.brake()
        if self.safety_mode == ROBOT_EMERGENCY_STOP and self.speed() == 0.0:
            self.robot_mode = POWER_OFF
        self.trace.extend(self.position)

    def follow(self, set_point, lookahead):
        """A critically damped servo, which is late by the lookahead time on a ramp."""
        stiffness = 2.0 / lookahead
        self.target = list(set_point)
        for axis in range(AXES):
            gap = set_point[axis] - self.position[axis]
            wanted = stiffness * stiffness * gap - 2.0 * stiffness * self.velocity[axis]
            change = min(max(wanted, -self.ACCELERATION), self.ACCELERATION) * self.cycle
            velocity = self.velocity[axis] + change
            self.velocity[axis] = min(max(velocity, -self.VELOCITY), self.VELOCITY)
            self.position[axis] += self.velocity[axis] * self.cycle

    def brake(self):
        """All axes come to rest together, the fastest with the deceleration of the stop."""
        speed = self.speed()
        share = max(0.0, 1.0 - self.deceleration * self.cycle / speed) if speed > 0.0 else 0.0
        for axis in range(AXES):
            self.velocity[axis] *= share
            self.position[axis] += self.velocity[axis] * self.cycle
        self.target = list(self.position)
