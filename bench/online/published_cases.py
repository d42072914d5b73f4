"""Writes the durations of the Python package `ruckig` for the requests of its own tests and examples.

Usage: published_cases.py > crates/rpi-motion/tests/online/published.csv

A line has the number of axes, interface, synchronisation and minimum duration, then eleven numbers for each axis (as in
`ruckig_reference.py`), then the duration and the shortest duration of each axis by itself.
"""

import ruckig

import ruckig_reference

ONE, ZERO = [1.0, 1.0, 1.0], [0.0, 0.0, 0.0]
EXAMPLE = [[0.0, 0.0, 0.5], [0.0, -2.2, -0.5], [0.0, 2.5, -0.5]]
EXAMPLE_LIMITS = [[3.0, 1.0, 3.0], [3.0, 2.0, 1.0], [4.0, 3.0, 2.0]]
REST = [[0.0, -2.0, 0.0], ZERO, ZERO]

# Interface, synchronisation, minimum duration, start, target, maxima of velocity, acceleration and jerk, and minima of
# velocity and acceleration, if they differ.
CASES = [
    (0, 1, 0, EXAMPLE, [[5.0, -2.0, -3.5], [0.0, -0.5, -2.0], [0.0, 0.0, 0.5]], EXAMPLE_LIMITS, None),
    (
        0, 1, 0, EXAMPLE, [[5.0, -2.0, -3.5], [0.0, -0.5, -2.0], [0.0, 0.0, 0.5]], EXAMPLE_LIMITS,
        [[-1.0, -0.5, -3.0], [-2.0, -1.0, -2.0]],
    ),
    (0, 0, 0, EXAMPLE, [[5.0, -2.0, -3.5], [0.0, -0.5, -2.0], [0.0, 0.0, 0.5]], EXAMPLE_LIMITS, None),
    (0, 1, 5.0, EXAMPLE, [[-5.0, -2.0, -3.5], [0.0, -0.5, -2.0], [0.0, 0.0, 0.5]], EXAMPLE_LIMITS, None),
    (
        1, 1, 0, [[0.0, 0.0, 0.5], [3.0, -2.2, -0.5], [0.0, 2.5, -0.5]], [ZERO, [0.0, -0.5, -1.5], [0.0, 0.0, 0.5]],
        [[10.0] * 3, [3.0, 2.0, 1.0], [6.0, 6.0, 4.0]], None,
    ),
    (1, 0, 0, EXAMPLE, [ZERO, ZERO, ZERO], [[10.0] * 3, [3.0, 2.0, 1.0], [12.0, 10.0, 8.0]], None),
    (0, 1, 0, REST, [[1.0, -3.0, 2.0], [0.0, 0.3, 0.0], ZERO], [ONE, ONE, ONE], None),
    (0, 0, 0, REST, [[1.0, -3.0, 2.0], [0.0, 0.3, 0.0], ZERO], [ONE, ONE, ONE], None),
    (0, 1, 0, REST, [[1.0, -3.0, 2.0], [0.2, -0.3, 0.8], ZERO], [ONE, ONE, ONE], None),
    (0, 1, 12.0, REST, [[1.0, -3.0, 2.0], [0.2, -0.3, 0.8], ZERO], [ONE, ONE, ONE], None),
    (
        0, 1, 0, [[1300.0, 0.0, 0.02], [1200.0, 0.0, 0.0], ZERO], [[1400.0, 0.0, 0.02], ZERO, ZERO],
        [[800.0, 1.0, 1.0], [40000.0, 1.0, 1.0], [200000.0, 1.0, 1.0]], None,
    ),
    (0, 2, 0, REST, [[1.0, -3.0, 2.0], ZERO, ZERO], [ONE, ONE, ONE], None),
    (0, 2, 0, REST, [[10.0, -3.0, 2.0], ZERO, ZERO], [[10.0, 2.0, 1.0]] * 3, None),
    (0, 2, 0, [[1.0, -2.0, 3.0], ZERO, ZERO], [[1.0, -2.0, 3.0], ZERO, ZERO], [[10.0, 2.0, 1.0]] * 3, None),
    (0, 2, 0, [ZERO, ZERO, ZERO], [ZERO, [0.2, 0.3, 0.4], ZERO], [ONE, ONE, ONE], None),
    (0, 2, 0, [ZERO, ZERO, ZERO], [[0.0, 0.0, 0.01], [0.2, 0.3, 0.4], ZERO], [ONE, ONE, ONE], None),
    (0, 2, 0, [ZERO, [0.4, 0.15, 0.2], [0.8, 0.3, 0.4]], [ZERO, ZERO, ZERO], [ONE, ONE, ONE], None),
    (
        1, 2, 0, [[0.0, 0.02, 1.0], [-0.2, 0.15, 0.2], [-0.4, 0.3, 0.4]], [ZERO, [-0.02, 0.015, 0.02], ZERO],
        [ONE, ONE, ONE], None,
    ),
    (
        1, 2, 0, [[0.0, 0.02, 1.0], [-0.2, 0.15, 0.2], [-0.4, 0.3, 0.4]], [ZERO, [-0.02, 0.015, 0.02], [0.01, 0.0, 0.0]],
        [ONE, ONE, ONE], None,
    ),
    (
        0, 1, 0, [[0.0, -2.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.2, 0.0]],
        [[1.0, -3.0, 2.0], [0.0, 0.0, 0.2], [0.0, 0.0, -0.1]], [ONE, ONE, ONE], None,
    ),
]


def main():
    """Writes a line for each request."""
    for interface, synchronisation, minimum, start, target, maxima, minima in CASES:
        minima = minima or [[-value for value in column] for column in maxima[:2]]
        columns = [*start, *target, maxima[0], minima[0], maxima[1], minima[1], maxima[2]]
        request = ruckig_reference.request_of([3, interface, synchronisation, minimum], columns)
        generator, trajectory = ruckig.Ruckig(3), ruckig.Trajectory(3)
        generator.calculate(request, trajectory)
        durations = [trajectory.duration, *trajectory.independent_min_durations]
        axes = [column[axis] for axis in range(3) for column in columns]
        print(",".join(repr(float(value)) for value in [3, interface, synchronisation, minimum, *axes, *durations]))


if __name__ == "__main__":
    main()
