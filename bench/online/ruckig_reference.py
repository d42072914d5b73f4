"""Durations of the Python package `ruckig` for requests in a binary file.

Usage: ruckig_reference.py REQUESTS RESULTS

A request is a row of little-endian doubles: number of axes, interface (0 position, 1 velocity), synchronisation (0 none,
1 time, 2 phase), minimum duration, and for each axis position, velocity and acceleration of start and target, maximum and
minimum velocity, maximum and minimum acceleration, maximum jerk. A result is a row of six doubles: 1 for a motion and 0
for an error, duration, largest error of position, velocity and acceleration, time of the calculation in s.
Results that the file already has are kept: the caller goes on after a crash of the package on a request.
"""

import array
import os
import sys
import time

import ruckig

SYNCHRONISATIONS = [ruckig.Synchronization.No, ruckig.Synchronization.Time, ruckig.Synchronization.Phase]
INTERFACES = [ruckig.ControlInterface.Position, ruckig.ControlInterface.Velocity]


def request_of(header, columns):
    """The request as an input of ruckig."""
    request = ruckig.InputParameter(len(columns[0]))
    request.control_interface = INTERFACES[int(header[1])]
    request.synchronization = SYNCHRONISATIONS[int(header[2])]
    if header[3] > 0:
        request.minimum_duration = header[3]
    request.current_position = columns[0]
    request.current_velocity = columns[1]
    request.current_acceleration = columns[2]
    request.target_position = columns[3]
    request.target_velocity = columns[4]
    request.target_acceleration = columns[5]
    request.max_velocity = columns[6]
    request.min_velocity = columns[7]
    request.max_acceleration = columns[8]
    request.min_acceleration = columns[9]
    request.max_jerk = columns[10]
    return request


def errors_of(trajectory, columns, is_velocity):
    """Largest error of position, velocity and acceleration at the end of all profiles. That of the velocity includes the
    excess over its limits after the return into these."""
    worst = [0.0, 0.0, 0.0]
    for axis, profile in enumerate(trajectory.profiles[0]):
        highest, lowest = columns[6][axis], columns[7][axis]
        excess = 0.0 if is_velocity else max(max(profile.v) / highest, min(profile.v) / lowest) - 1.0
        errors = [
            0.0 if is_velocity else abs(profile.p[-1] - profile.pf),
            max(abs(profile.v[-1] - profile.vf), excess),
            abs(profile.a[-1] - profile.af),
        ]
        worst = [max(pair) for pair in zip(worst, errors)]
    return worst


def main():
    """Reads the requests and appends the results that are missing."""
    numbers = array.array("d")
    with open(sys.argv[1], "rb") as requests:
        numbers.frombytes(requests.read())
    generators = {}
    at = 0
    with open(sys.argv[2], "ab", buffering=0) as output:
        missing = os.path.getsize(sys.argv[2]) // 48
        while at < len(numbers):
            axes = int(numbers[at])
            header = numbers[at : at + 4]
            values = numbers[at + 4 : at + 4 + 11 * axes]
            at += 4 + 11 * axes
            if missing > 0:
                missing -= 1
                continue
            columns = [values[k::11].tolist() for k in range(11)]
            generator = generators.setdefault(axes, ruckig.Ruckig(axes))
            output.write(array.array("d", result_of(generator, header, columns)).tobytes())


def result_of(generator, header, columns):
    """The result row of a request."""
    request = request_of(header, columns)
    trajectory = ruckig.Trajectory(request.degrees_of_freedom)
    begin = time.perf_counter()
    try:
        status = generator.calculate(request, trajectory)
    except (RuntimeError, ValueError, ruckig.RuckigError):
        status = None
    spent = time.perf_counter() - begin
    if status in (ruckig.Result.Working, ruckig.Result.Finished):
        return [1.0, trajectory.duration, *errors_of(trajectory, columns, header[1] == 1), spent]
    return [0.0, 0.0, 0.0, 0.0, 0.0, spent]


if __name__ == "__main__":
    main()
