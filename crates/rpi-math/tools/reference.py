#!/usr/bin/env python3
"""Values of the functions in high precision, for the tests. Needs Python 3 and mpmath.

    python3 crates/rpi-math/tools/reference.py            # writes tests/data/NAME.txt
    python3 crates/rpi-math/tools/reference.py 1000000 7  # prints that many lines for each function; 7 is the seed

A line has the bits of the arguments, of the nearest real of the value, and of the rest as a real in units in the last
place. Names of functions stand on lines of their own in the output. The arguments are random ones in the usual domain, and hard ones:
next to multiples of pi / 64, to the borders of the tables, to thresholds, and over the whole range of exponents.
"""

import math
import pathlib
import random
import struct
import sys

import mpmath
from mpmath import mp, mpf

DATA = pathlib.Path(__file__).resolve().parent.parent / "tests" / "data"
PRECISION = 200
COUNT = 2000


def real(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def bits(value):
    return struct.unpack("<Q", struct.pack("<d", value))[0]


class Arguments:
    """Generators of arguments."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.uniform = self.random.uniform

    def any(self):
        while True:
            x = real(self.random.getrandbits(64))
            if math.isfinite(x):
                return x

    def positive(self):
        return abs(self.any())

    def scaled(self, low, high):
        """A number whose logarithm to base 2 is between the bounds."""
        return self.random.choice([-1, 1]) * 2.0 ** self.uniform(low, high)

    def near(self, x):
        for _ in range(self.random.randrange(0, 20)):
            x = math.nextafter(x, self.random.choice([-math.inf, math.inf]))
        return x

    def multiple_of_pi(self):
        return self.near(self.random.randrange(-200000, 200000) * math.pi / 64)

    def close_to_one(self, low):
        return 1 + self.random.choice([-1, 1]) * 2.0 ** self.uniform(low, -2)

    def inside_one(self):
        return self.random.choice([-1, 1]) * (1 - 2.0 ** self.uniform(-53, -1))

    def border_of_logarithms(self):
        return self.near(real(0x3FE6100000000000 + (self.random.randrange(0, 256) << 45)))

    def border_of_arctangents(self):
        return self.near(self.random.randrange(-130, 130) / 128)

    def border_of_powers(self):
        return self.near(self.random.randrange(-2000, 2000) * math.log(2) / 256)

    def coordinate(self):
        return self.random.choice([
            lambda: self.uniform(-1, 1), self.any, lambda: self.scaled(-80, 80), lambda: self.scaled(-1074, -900),
            lambda: self.scaled(1000, 1022.9)])()


def trigonometric(a):
    # The angle of all reals that is closest to a multiple of pi / 2.
    worst = 6381956970095103 * 2.0**797
    return [lambda: a.uniform(-4, 4), lambda: a.uniform(-1000, 1000), a.any, a.multiple_of_pi,
            lambda: a.scaled(-30, 20), lambda: a.uniform(-0.1, 0.1), lambda: a.near(worst)]


def inverse(a):
    return [lambda: a.uniform(-1, 1), lambda: a.scaled(-60, 0), lambda: a.near(0.5), a.inside_one]


FUNCTIONS = {
    "sin": (mpmath.sin, trigonometric),
    "cos": (mpmath.cos, trigonometric),
    "tan": (mpmath.tan, trigonometric),
    "asin": (mpmath.asin, inverse),
    "acos": (mpmath.acos, inverse),
    "atan": (mpmath.atan, lambda a: [
        lambda: a.uniform(-4, 4), a.any, lambda: a.scaled(-30, 62), a.border_of_arctangents,
        lambda: a.near(2.0**60)]),
    "exp": (mpmath.exp, lambda a: [
        lambda: a.uniform(-1, 1), lambda: a.uniform(-746, 710), lambda: a.scaled(-60, 9.4),
        lambda: a.uniform(-746, -700), a.border_of_powers, lambda: a.near(709.782712893384)]),
    "expm1": (mpmath.expm1, lambda a: [
        lambda: a.uniform(-1, 1), lambda: a.uniform(-60, 709), lambda: a.scaled(-60, 9.4),
        lambda: a.uniform(-0.2, 0.2), lambda: a.near(0.125), lambda: a.near(-50)]),
    "tanh": (mpmath.tanh, lambda a: [
        lambda: a.uniform(-1, 1), lambda: a.uniform(-25, 25), lambda: a.scaled(-60, 5), lambda: a.near(0.25)]),
    "log": (mpmath.log, lambda a: [
        lambda: a.uniform(1e-9, 4), a.positive, lambda: a.uniform(0.98, 1.02), lambda: a.close_to_one(-53),
        a.border_of_logarithms]),
    "cbrt": (lambda x: mpmath.sign(x) * mpmath.cbrt(abs(x)), lambda a: [
        lambda: a.uniform(-8, 8), a.any, lambda: a.scaled(-1074, -1000), lambda: a.near(8.0 ** a.random.randrange(-9, 9))]),
    "atan2": (mpmath.atan2, lambda a: [
        lambda: (a.uniform(-1, 1), a.uniform(-1, 1)), lambda: (a.coordinate(), a.coordinate()),
        lambda: (a.scaled(-70, 70), a.scaled(-3, 3)), lambda: (a.border_of_arctangents(), 1.0)]),
    "hypot": (mpmath.hypot, lambda a: [
        lambda: (a.uniform(-1, 1), a.uniform(-1, 1)), lambda: (a.coordinate(), a.coordinate()),
        lambda: (a.scaled(-40, 40), a.scaled(-3, 3))]),
    "pow": (mpmath.power, lambda a: [
        lambda: (a.uniform(1e-9, 10), a.uniform(-10, 10)), lambda: (a.positive(), a.uniform(-1, 1)),
        lambda: (a.uniform(0.9, 1.1), a.uniform(-5000, 5000)), lambda: (a.close_to_one(-52), a.scaled(0, 50)),
        lambda: (float(-a.random.randrange(1, 1000)), float(a.random.randrange(-100, 100)))]),
}


def value(function, arguments):
    """Value as the nearest real and the rest in its last place, or nothing where it is 0 or beyond the range of reals."""
    exact = function(*(mpf(x) for x in arguments))
    if exact == 0 or not mpmath.isfinite(exact) or abs(exact) >= mpf(2) ** 1024 or abs(exact) < mpf(2) ** -1074:
        return None
    nearest = float(exact)
    return None if math.isinf(nearest) else (nearest, float((exact - mpf(nearest)) / mpf(math.ulp(nearest))))


def lines(name, count, seed):
    function, generators = FUNCTIONS[name]
    source = Arguments(f"{name} {seed}")
    kinds = generators(source)
    produced = 0
    while produced < count:
        arguments = kinds[source.random.randrange(len(kinds))]()
        arguments = arguments if isinstance(arguments, tuple) else (arguments,)
        # Trigonometric functions of large angles need more bits.
        mp.prec = 1300 if name in ("sin", "cos", "tan") and abs(arguments[0]) > 1e9 else PRECISION
        result = value(function, arguments)
        if result is not None:
            produced += 1
            yield " ".join(f"{bits(x):016x}" for x in (*arguments, *result))


def main():
    if sys.argv[1:]:
        count, seed = map(int, sys.argv[1:])
        for name in FUNCTIONS:
            print(name)
            for line in lines(name, count, seed):
                print(line)
        return
    for name in FUNCTIONS:
        (DATA / f"{name}.txt").write_text("\n".join(lines(name, COUNT, 1)) + "\n")


if __name__ == "__main__":
    main()
