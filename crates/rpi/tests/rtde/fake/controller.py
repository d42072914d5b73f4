"""A controller like those of Universal Robots, without a robot: RTDE, the port for programs, and a simulated arm.

    python3 controller.py [--joints Q0 .. Q5] [--frequency 500] [--trace FILE] [--rtde-port 0] [--script-port 0]

Ports of 0 are chosen by the system. Prints `PORTS rtde script`, then a line for each event. Reads commands from standard input, one in a line:

    stall MS      sends no states for this time        deaf MS     ignores set-points for this time
    loss SHARE    loses this share of data packages    drop        closes all RTDE connections
    protective    protective stop                      pause       protective stop that pauses the program
    estop         emergency stop                       unlock      the operator ends the stop, and switches the robot on
    stop          the operator stops the program       scale SHARE the operator sets the speed to this share
    end           ends this process, as the end of standard input does
    when-moving COMMAND          does the command as soon as an axis is faster than 0.2 rad/s
    when-faster SPEED COMMAND    does the command as soon as an axis is faster than this speed, in rad/s

At its end, writes the positions of each cycle to the file, as doubles of this machine.
"""

import argparse
import os
import random
import select
import time

from robot import Robot
from rtde_server import ProgramServer, RtdeServer


class Controller:
    def __init__(self, options):
        self.robot = Robot(options.joints, 1.0 / options.frequency)
        version = (5, 15, 0, 1) if options.frequency > 125 else (3, 15, 0, 1)
        self.rtde = RtdeServer(self.robot, options.rtde_port, version)
        self.programs = ProgramServer(self.robot, options.script_port)
        self.random = random.Random(1)
        self.loss = 0.0
        self.stalled = self.deaf = 0
        self.waiting = []
        self.unread = ""
        self.is_over = False

    def is_lost(self):
        return self.random.random() < self.loss

    def obey(self, line):
        words = line.split()
        if not words:
            return
        robot, name = self.robot, words[0]
        cycles = lambda: round(float(words[1]) / 1000.0 / robot.cycle)
        if name == "when-moving":
            return self.waiting.append((0.2, " ".join(words[1:])))
        if name == "when-faster":
            return self.waiting.append((float(words[1]), " ".join(words[2:])))
        if name == "stall":
            self.stalled = cycles()
        elif name == "deaf":
            self.deaf = cycles()
        elif name == "loss":
            self.loss = float(words[1])
        elif name == "drop":
            self.rtde.drop_all()
        elif name == "scale":
            robot.scaling = float(words[1])
        elif name == "protective":
            robot.protective_stop()
        elif name == "pause":
            robot.protective_pause()
        elif name == "estop":
            robot.emergency_stop()
        elif name == "unlock":
            robot.unlock()
        elif name == "stop":
            robot.end_program("the operator")
        elif name == "end":
            self.is_over = True
        else:
            return print(f"UNKNOWN {line}", flush=True)
        print(f"DONE {line} at {robot.clock:.3f} s, {robot.speed():.3f} rad/s", flush=True)

    def read_commands(self):
        # Not by lines: what the buffer of a file has read, `select` does not see.
        while select.select([0], [], [], 0)[0] and not self.is_over:
            new = os.read(0, 4096)
            self.is_over = not new
            *lines, self.unread = (self.unread + new.decode()).split("\n")
            for line in lines:
                self.obey(line)
        if self.waiting and self.robot.speed() > self.waiting[0][0]:
            self.obey(self.waiting.pop(0)[1])

    def cycle(self):
        self.rtde.receive(lambda: self.deaf > 0 or self.is_lost())
        self.programs.receive()
        self.robot.step()
        self.rtde.send_states(lambda: self.stalled > 0 or self.is_lost())
        self.stalled, self.deaf = max(0, self.stalled - 1), max(0, self.deaf - 1)
        for text in self.robot.log:
            print(f"{text} at {self.robot.clock:.3f} s", flush=True)
        self.robot.log.clear()

    def run(self):
        due = time.monotonic()
        while not self.is_over:
            self.cycle()
            # Late cycles delay the clock: it is the controller's own. Commands wait for every fifth cycle.
            if self.robot.cycles % 5 == 0 or self.waiting:
                self.read_commands()
            due = max(due + self.robot.cycle, time.monotonic())
            time.sleep(max(0.0, due - time.monotonic()))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--joints", type=float, nargs=6, default=[0.0, -1.57, 1.57, -1.57, -1.57, 0.0])
    parser.add_argument("--frequency", type=float, default=500.0)
    parser.add_argument("--rtde-port", type=int, default=0)
    parser.add_argument("--script-port", type=int, default=0)
    parser.add_argument("--trace")
    options = parser.parse_args()
    controller = Controller(options)
    print(f"PORTS {controller.rtde.port} {controller.programs.port}", flush=True)
    controller.run()
    if options.trace:
        with open(options.trace, "wb") as file:
            controller.robot.trace.tofile(file)
    print(f"REST {controller.robot.speed() == 0.0} {controller.robot.clock:.3f} s", flush=True)


if __name__ == "__main__":
    main()
