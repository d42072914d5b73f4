#!/usr/bin/env python3
"""Computes the coefficients and tables of this crate: constants and tables in `src` (Rust) and `src/c` (C).

The polynomials are minimax approximations (exchange algorithm of Remez) in 260 bits, whose coefficients are then
rounded to double precision. The tables are rounded values of the functions themselves. Needs Python 3 and mpmath.

    python3 crates/rpi-math/tools/generate.py           # writes the files
    python3 crates/rpi-math/tools/generate.py --check   # fails if the files differ from what would be written
"""

import pathlib
import sys

import mpmath
from mpmath import mp, mpf

mp.prec = 260
SOURCES = pathlib.Path(__file__).resolve().parent.parent / "src"


def double(value):
    """Nearest double."""
    return float(value)


def short(value, bits):
    """Nearest number with at most `bits` significant bits."""
    if value == 0:
        return 0.0
    scale = mpf(2) ** (bits - 1 - int(mpmath.floor(mpmath.log(abs(value), 2))))
    return float(mpmath.nint(value * scale) / scale)


def multiple(value, unit):
    """Nearest multiple of `unit`."""
    return float(mpmath.nint(value / unit) * unit)


def pair(value, bits=53):
    """`value` as a sum of a number with `bits` bits and a double."""
    high = short(value, bits)
    return high, double(value - high)


def triple(value, first, second):
    """`value` as a sum of numbers with `first`, `second` and 53 bits."""
    high = short(value, first)
    middle = short(value - high, second)
    return high, middle, double(value - high - middle)


def solve(points, degree, function, weight):
    """Coefficients whose weighted error alternates with equal size at the points, and this size."""
    count = degree + 2
    matrix = mpmath.matrix(count, count)
    right = mpmath.matrix(count, 1)
    for row, x in enumerate(points):
        for k in range(degree + 1):
            matrix[row, k] = x**k
        matrix[row, count - 1] = (-1) ** row / weight(x)
        right[row] = function(x)
    solution = mpmath.lu_solve(matrix, right)
    return [solution[k] for k in range(degree + 1)], abs(solution[count - 1])


def extremes(error, low, high, count):
    """Points of the largest errors between sign changes, on a grid that is dense at both ends."""
    size = 60 * count
    grid = [(low + high) / 2 - (high - low) / 2 * mpmath.cos(mp.pi * k / size) for k in range(size + 1)]
    values = [error(x) for x in grid]
    runs = []
    for x, value in zip(grid, values):
        if runs and (runs[-1][1] > 0) == (value > 0):
            if abs(value) > abs(runs[-1][1]):
                runs[-1] = (x, value)
        else:
            runs.append((x, value))
    while len(runs) > count:
        runs.pop(0 if abs(runs[0][1]) < abs(runs[-1][1]) else -1)
    return runs


def remez(function, degree, low, high, weight=lambda x: mpf(1)):
    """Coefficients of the polynomial with the least greatest error `|weight (p - function)|`, and this error."""
    low, high = mpf(low), mpf(high)
    count = degree + 2
    points = [(low + high) / 2 - (high - low) / 2 * mpmath.cos(mp.pi * k / (count - 1)) for k in range(count)]
    for _ in range(30):
        coefficients, level = solve(points, degree, function, weight)
        runs = extremes(lambda x: weight(x) * (mpmath.polyval(coefficients[::-1], x) - function(x)), low, high, count)
        if len(runs) < count:
            raise ValueError("no alternation: the precision is too small")
        points = [x for x, _ in runs]
        largest = max(abs(value) for _, value in runs)
        if largest < level * (1 + mpf("1e-3")):
            break
    return coefficients, largest


def series(coefficient, shift):
    """The function z -> sum of coefficient(k + shift) z^k, without cancellation at 0."""

    def value(z):
        total, k, power = mpf(0), 0, mpf(1)
        while True:
            term = coefficient(k + shift) * power
            total += term
            if k > 4 and abs(term) < mpf(2) ** -240:
                return total
            power *= z
            k += 1

    return value


def asin_coefficient(k):
    return mpmath.binomial(2 * k, k) / (mpf(4) ** k * (2 * k + 1))


def tanh_rest(z):
    """(tanh x - x) / x^3 of z = x^2."""
    if z < mpf(2) ** -60:
        return -mpf(1) / 3 + 2 * z / 15
    x = mpmath.sqrt(z)
    return (mpmath.tanh(x) - x) / (x * z)


def polynomials():
    """Name, meaning, coefficients and error of each polynomial, the constant term first."""
    bound = (mp.pi / 64) ** 2 * mpf("1.001")
    yield "SIN", "(sin r - r) / r^3 of r^2, for |r| up to pi / 64", remez(
        series(lambda k: (-1) ** k / mpmath.factorial(2 * k + 1), 1), 2, 0, bound, lambda z: z + mpf(2) ** -30)
    yield "COS", "(cos r - 1 + r^2 / 2) / r^4 of r^2, for |r| up to pi / 64", remez(
        series(lambda k: (-1) ** k / mpmath.factorial(2 * k), 2), 2, 0, bound, lambda z: z * z + mpf(2) ** -30)
    bound = mpmath.log(2) / 256 * mpf("1.001")
    yield "EXP", "(exp r - 1 - r - r^2 / 2) / r^3 of r, for |r| up to log 2 / 256", remez(
        series(lambda k: 1 / mpmath.factorial(k), 3), 3, -bound, bound)
    yield "EXPM1", "(exp x - 1 - x - x^2 / 2) / x^3 of x, for |x| up to 1 / 8", remez(
        series(lambda k: 1 / mpmath.factorial(k), 3), 7, mpf(-1) / 8, mpf(1) / 8)
    yield "LOG", "(log (1 + r) - r + r^2 / 2) / r^3 of r, for |r| up to 0.0042", remez(
        series(lambda k: mpf((-1) ** (k + 1)) / k, 3), 5, mpf("-0.0042"), mpf("0.0042"))
    yield "ASIN", "(asin x - x) / x^3 of x^2, for |x| up to 1 / 2", remez(
        series(asin_coefficient, 1), 15, 0, mpf(1) / 4)
    yield "TANH", "(tanh x - x) / x^3 of x^2, for |x| up to 1 / 4", remez(tanh_rest, 7, 0, mpf(1) / 16)
    yield "CBRT", "m^(-1/3) of m - 1, for m from 1 to 2", remez(
        lambda x: (1 + x) ** (-mpf(1) / 3), 3, 0, 1, lambda x: (1 + x) ** (mpf(1) / 3))


def logarithm_row(index):
    """Row of the table of logarithms: a short reciprocal of the middle of an interval, and minus its logarithm."""
    start = 0x3FE6100000000000 + (index << 45)
    middle = real_of_bits(start + (1 << 44))
    if start < 0x3FF0000000000000 <= start + (1 << 45):
        return 1.0, 0.0, 0.0
    inverse = multiple(1 / mpf(middle), mpf(2) ** -12)
    value = -mpmath.log(mpf(inverse))
    high = multiple(value, mpf(2) ** -42)
    return inverse, high, double(value - high)


def real_of_bits(bits):
    exponent = (bits >> 52) - 1023
    return mpf((bits & ((1 << 52) - 1)) | (1 << 52)) * mpf(2) ** (exponent - 52)


def arctangent_row(index):
    """Row of the table of arctangents around c = index / 64: the value, and the polynomial of the rest."""
    c = mpf(index) / 64
    root = 1 / mpmath.mpc(c, -1)
    taylor = [mpf((-1) ** (n - 1)) / n * (root**n).imag for n in range(1, 48)]
    taylor[0] -= 1
    # Only odd powers around 0, where the error is relative to d.
    rest = taylor[:7] if index == 0 else remez(
        lambda d: mpmath.polyval(taylor[::-1], d), 6, -ARCTANGENT_STEP, ARCTANGENT_STEP)[0]
    return pair(mpmath.atan(c)), tuple(double(term) for term in rest)


ARCTANGENT_STEP = mpf(1) / 128 * mpf("1.01")


def circle_tables():
    """Name, meaning and rows of the tables for trigonometric functions."""
    angle = lambda k: mpmath.sin(mp.pi * k / 32) if k % 32 else mpf(0)
    yield ("SINES", "sin (k pi / 32): 26 bits, the rest, and the nearest real",
           [(*pair(angle(k), 26), double(angle(k))) for k in range(64)])
    rows = [arctangent_row(k) for k in range(65)]
    yield ("ANGLES", "atan c for c = k / 64: the nearest real and the rest",
           [row[0] for row in rows])
    yield "ANGLE_TERMS", "coefficients of (atan (c + d) - atan c - d) / d of d, for |d| up to 1 / 128", [row[1] for row in rows]


def power_tables():
    """Name, meaning and rows of the tables for powers, logarithms and roots."""
    yield "POWERS", "2^(k / 128): the nearest real, and the rest", [pair(mpf(2) ** (mpf(k) / 128)) for k in range(128)]
    yield ("LOGARITHMS", "reciprocal c of the middle of an interval in 13 bits; -log c as a multiple of 2^-42, and the rest",
           [logarithm_row(k) for k in range(128)])
    root = [(double(mpf(2) ** (-mpf(k) / 3)), double(mpf(2) ** k)) for k in range(3)]
    yield "CUBE_ROOTS", "2^(-k / 3) and 2^k", root


def scalars():
    """Name, meaning and value of each constant."""
    step = triple(mp.pi / 32, 32, 32)
    for name, value in zip(("STEP_HIGH", "STEP_MIDDLE", "STEP_LOW"), step):
        yield name, "part of pi / 32 = STEP_HIGH + STEP_MIDDLE + STEP_LOW; the first two have 32 bits", value
    yield "STEPS_PER_UNIT", "32 / pi", double(32 / mp.pi)
    high, low = pair(2 * mp.pi)
    yield "TURN_HIGH", "part of 2 pi = TURN_HIGH + TURN_LOW", high
    yield "TURN_LOW", "part of 2 pi = TURN_HIGH + TURN_LOW", low
    high, low = pair(mp.pi / 2)
    yield "QUARTER_HIGH", "part of pi / 2 = QUARTER_HIGH + QUARTER_LOW", high
    yield "QUARTER_LOW", "part of pi / 2 = QUARTER_HIGH + QUARTER_LOW", low
    yield "POWER_STEPS_PER_UNIT", "128 / log 2", double(128 / mpmath.log(2))
    high, low = pair(mpmath.log(2) / 128, 35)
    yield "POWER_STEP_HIGH", "part of log 2 / 128 = POWER_STEP_HIGH + POWER_STEP_LOW; 35 bits", high
    yield "POWER_STEP_LOW", "part of log 2 / 128 = POWER_STEP_HIGH + POWER_STEP_LOW", low
    value = mpmath.log(2)
    high = multiple(value, mpf(2) ** -42)
    yield "LN_TWO_HIGH", "part of log 2 = LN_TWO_HIGH + LN_TWO_LOW; a multiple of 2^-42", high
    yield "LN_TWO_LOW", "part of log 2 = LN_TWO_HIGH + LN_TWO_LOW", double(value - high)


def turn_words():
    """Fraction of 1 / (2 pi) in words of 32 bits, after two words of zeros for angles below 2^52."""
    count = 38
    with mpmath.workprec(32 * count + 64):
        bits = int(mpmath.floor(mpf(2) ** (32 * count) / (2 * mp.pi)))
    return [0, 0] + [(bits >> (32 * (count - 1 - k))) & 0xFFFFFFFF for k in range(count)]


NOTE = "Written by tools/generate.py: do not edit."


def rows_of(values, size):
    """Rows of `size` values."""
    return [values[k:k + size] for k in range(0, len(values), size)]


def row(values):
    return ", ".join(repr(value) for value in values)


def entries(polys):
    """Name, meaning and value of the constants: a number, or the coefficients of a polynomial in rows of three or four."""
    yield from ((name, f"{meaning[0].upper()}{meaning[1:]}.", value) for name, meaning, value in scalars())
    for name, meaning, (coefficients, error) in polys:
        text = f"Coefficients of {meaning}. Error of the approximation: {mpmath.nstr(error, 2)}."
        yield name + "_TERMS", text, rows_of([double(c) for c in coefficients], 3 if len(coefficients) % 3 == 0 else 4)


def rust_constants(polys):
    out = [f"//! Constants and coefficients of polynomials. {NOTE}", ""]
    for name, meaning, value in entries(polys):
        out.append(f"/// {meaning}")
        if isinstance(value, float):
            out.append(f"pub(crate) const {name}: f64 = {value!r};")
        else:
            out.append(f"pub(crate) const {name}: [[f64; {len(value[0])}]; {len(value)}] = [")
            out += [f"    [{row(values)}]," for values in value] + ["];"]
    return out


def rust_tables(subject, tables):
    out = [f"//! Tables for {subject}. {NOTE}", ""]
    for name, meaning, rows in tables:
        out += [f"/// Row k: {meaning}.", f"pub(crate) static {name}: [[f64; {len(rows[0])}]; {len(rows)}] = ["]
        out += [f"    [{row(values)}]," for values in rows] + ["];"]
    return out


def rust_words(words):
    out = [f"/// {WORDS}", f"pub(crate) static TURN_WORDS: [u32; {len(words)}] = ["]
    out += ["    " + " ".join(f"0x{word:08x}," for word in values) for values in rows_of(words, 4)] + ["];"]
    return out


WORDS = "Two words of zeros, then the fraction of 1 / (2 pi) in words of 32 bits, the first one first."


def c_head(name, meaning):
    return [f"/*# rpi_{name.lower()} */", f"/* {meaning} */"]


def c_array(name, meaning, rows):
    out = c_head(name, meaning)
    out.append(f"static const double rpi_{name.lower()}[{len(rows)}][{len(rows[0])}] = {{")
    return out + [f"  {{{row(values)}}}," for values in rows] + ["};"]


def c_constants(polys):
    out = []
    for name, meaning, value in entries(polys):
        if isinstance(value, float):
            out += c_head(name, meaning) + [f"static const double rpi_{name.lower()} = {value!r};"]
        else:
            out += c_array(name, meaning, value)
    return out


def c_tables(tables):
    out = []
    for name, meaning, rows in tables:
        out += c_array(name, f"Row k: {meaning}.", rows)
    return out


def c_words(words):
    out = c_head("TURN_WORDS", WORDS) + [f"static const uint32_t rpi_turn_words[{len(words)}] = {{"]
    out += ["  " + " ".join(f"0x{word:08x}U," for word in values) for values in rows_of(words, 4)] + ["};"]
    return out


def main():
    polys, words = list(polynomials()), turn_words()
    circle, powers = list(circle_tables()), list(power_tables())
    parts = {
        "constants.rs": rust_constants(polys),
        "circle_tables.rs": rust_tables("trigonometric functions", circle) + rust_words(words),
        "power_tables.rs": rust_tables("powers, logarithms and roots", powers),
        "c/constants.c": c_constants(polys),
        "c/circle_tables.c": c_tables(circle) + c_words(words),
        "c/power_tables.c": c_tables(powers),
    }
    texts = {path: "\n".join(lines) + "\n" for path, lines in parts.items()}
    different = [path for path, text in texts.items() if text != (SOURCES / path).read_text()] \
        if sys.argv[1:] == ["--check"] else []
    for path in different:
        print(f"{path} differs from the output of the generator", file=sys.stderr)
    if sys.argv[1:] != ["--check"]:
        for path, text in texts.items():
            (SOURCES / path).write_text(text)
    sys.exit(bool(different))


if __name__ == "__main__":
    main()
