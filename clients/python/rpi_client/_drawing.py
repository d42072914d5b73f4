"""Drawings as SVG: curves over time, and time lines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Svg:
    """A drawing, which Jupyter shows: its ``text`` in SVG."""

    text: str

    def save(self, path: str | Path) -> None:
        """Writes the drawing to a file."""
        Path(path).write_text(self.text, encoding="utf-8")

    def _repr_svg_(self) -> str:
        return self.text


@dataclass(frozen=True)
class Span:
    """A bar of a time line: its ``row``, ``label``, start and end in seconds, and whether it ended by an error."""

    row: str
    label: str
    start: float
    end: float
    failed: bool = False


@dataclass(frozen=True)
class Mark:
    """An instant of a time line, in seconds, with a ``label``."""

    time: float
    label: str


#: Colours that people with any colour vision distinguish (Okabe and Ito, "Color Universal Design", 2008), without yellow and black.
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#7f7f7f")
#: Dashes for the next curves in the same colours.
_DASHES = ("", "6 3", "2 2", "8 3 2 3")
_WIDTH, _PLOT_WIDTH, _LEFT, _TOP = 820, 540, 70, 34
_PLOT_HEIGHT, _LINE = 260, 16
#: Number of columns of a plot in which only the lowest and the highest value of a curve are drawn: a long recording gives no larger file.
_PIXELS = 2 * _PLOT_WIDTH


@dataclass(frozen=True)
class _Axis:
    """Scale from values to pixels."""

    low: float
    high: float
    from_pixel: float
    to_pixel: float

    def at(self, value: float) -> float:
        share = (value - self.low) / (self.high - self.low)
        return self.from_pixel + share * (self.to_pixel - self.from_pixel)

    def ticks(self) -> Iterator[tuple[float, str]]:
        """Yields four to nine round values, each with its text."""
        rough = (self.high - self.low) / 8
        power = 10.0 ** math.floor(math.log10(rough))
        step = next(power * factor for factor in (1, 2, 5, 10) if power * factor >= rough)
        for k in range(math.ceil(self.low / step), math.floor(self.high / step) + 1):
            yield k * step, f"{k * step:.6g}"


def _axis(values: list[float], from_pixel: float, to_pixel: float, margin: float) -> _Axis:
    """Returns the axis on which these values fit. They are finite."""
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    span = (high - low) or abs(high) or 1.0
    # A span of nothing but rounding is drawn as a line, and one that overflows is not drawn to scale.
    span = min(max(span, 1e-12 * max(abs(low), abs(high)), 1e-300), 1e300)
    extra = span * margin if high > low else span / 2
    return _Axis(low - extra, high + extra, from_pixel, to_pixel)


def draw_curves(title: str, times: Sequence[float], curves: dict[str, list[Any]]) -> Svg:
    """Draws curves over the same times in seconds. None, NaN and infinite values are gaps."""
    finite = [float(value) for values in curves.values() for value in values if value is not None and math.isfinite(value)]
    # Half of the range keeps differences finite.
    finite = [value for value in finite if abs(value) < 1e300]
    bottom = _TOP + _PLOT_HEIGHT
    across = _axis([time for time in times if math.isfinite(time)], _LEFT, _LEFT + _PLOT_WIDTH, 0.0)
    up = _axis(finite, bottom, _TOP, 0.05)
    parts = [*_frame(title, across, bottom), *_grid(up)]
    for number, (name, values) in enumerate(curves.items()):
        colour = _COLOURS[number % len(_COLOURS)]
        dash = _DASHES[number // len(_COLOURS) % len(_DASHES)]
        style = f'stroke="{colour}" stroke-width="1.5" stroke-dasharray="{dash}"'
        parts.append(f'<path d="{_path(times, values, across, up)}" fill="none" {style}/>')
        y = _TOP + 6 + number * _LINE
        x = _LEFT + _PLOT_WIDTH + 12
        parts.append(f'<line x1="{x}" y1="{y}" x2="{x + 18}" y2="{y}" {style}/>')
        parts.append(_text(x + 24, y + 4, _short(name, 24), full=name))
    height = max(bottom + 40, _TOP + len(curves) * _LINE + 10)
    return _svg(parts, height)


def _path(times: Sequence[float], values: list[Any], across: _Axis, up: _Axis) -> str:
    """Returns the path of a curve: in each column of pixels its first, lowest, highest and last point."""
    path: list[str] = []
    column: list[tuple[float, float]] = []
    pen = "M"

    def draw() -> None:
        nonlocal pen
        kept = {0, len(column) - 1, *(pick(range(len(column)), key=lambda k: column[k][1]) for pick in (min, max))}
        for k in sorted(kept):
            path.append(f"{pen}{column[k][0]:.1f} {column[k][1]:.1f}")
            pen = "L"
        column.clear()

    last = -1
    for time, value in zip(times, values, strict=True):
        is_gap = value is None or not math.isfinite(value) or abs(value) >= 1e300 or not math.isfinite(time)
        pixel = -1 if is_gap else int((across.at(time) - _LEFT) / _PLOT_WIDTH * _PIXELS)
        if column and pixel != last:
            draw()
        if is_gap:
            pen = "M"
        else:
            column.append((across.at(time), up.at(value)))
        last = pixel
    if column:
        draw()
    # A point alone between gaps is a dot: a line of length 0 with round ends.
    return "".join(path)


def draw_timeline(title: str, spans: Sequence[Span], marks: Sequence[Mark]) -> Svg:
    """Draws bars by row over time in seconds, in the order of the first bar of each row, with marks below them."""
    rows = list(dict.fromkeys(span.row for span in spans))
    times = [time for span in spans for time in (span.start, span.end)] + [mark.time for mark in marks]
    step = 24
    bottom = _TOP + step * (len(rows) + (1 if marks else 0))
    across = _axis(times, _LEFT + 60, _LEFT + 60 + _PLOT_WIDTH + 80, 0.0)
    parts = _frame(title, across, bottom)
    for number, row in enumerate(rows):
        parts.append(_text(_LEFT + 54, _TOP + step * number + 16, _short(row, 20), "end", row))
        for span in (span for span in spans if span.row == row):
            parts += _bar(span, across, _TOP + step * number, _COLOURS[number % len(_COLOURS)])
    for mark in marks:
        x, y = across.at(mark.time), bottom - step / 2
        parts.append(f'<path d="M{x:.1f} {y - 5}l5 10h-10z" fill="#d55e00"><title>{escape(mark.label)}</title></path>')
    return _svg(parts, bottom + 40)


def _bar(span: Span, across: _Axis, y: float, colour: str) -> list[str]:
    x, width = across.at(span.start), max(across.at(span.end) - across.at(span.start), 1.0)
    border = ' stroke="#c00000" stroke-width="2"' if span.failed else ""
    label = f"{span.row}: {span.label}, {span.start:.3f} s to {span.end:.3f} s"
    rectangle = f'<rect x="{x:.1f}" y="{y + 3}" width="{width:.1f}" height="18" fill="{colour}" fill-opacity="0.35"{border}>'
    parts = [f"{rectangle}<title>{escape(label)}</title></rect>"]
    # About 6.5 pixels for a letter: a label that does not fit into its bar is in its tooltip only.
    if 6.5 * len(span.label) + 6 < width:
        parts.append(_text(x + 4, y + 16, span.label))
    return parts


def _frame(title: str, across: _Axis, bottom: float) -> list[str]:
    left, right = across.from_pixel, across.to_pixel
    parts = [_text(left, 20, _short(title, 80), weight="bold", full=title)]
    for value, text in across.ticks():
        x = across.at(value)
        parts.append(f'<line x1="{x:.1f}" y1="{_TOP}" x2="{x:.1f}" y2="{bottom}" stroke="#dddddd"/>')
        parts.append(_text(x, bottom + 16, text, "middle"))
    parts.append(_text((left + right) / 2, bottom + 32, "time in s", "middle"))
    parts.append(f'<rect x="{left}" y="{_TOP}" width="{right - left}" height="{bottom - _TOP}" fill="none" stroke="#555555"/>')
    return parts


def _grid(up: _Axis) -> Iterator[str]:
    for value, text in up.ticks():
        y = up.at(value)
        yield f'<line x1="{_LEFT}" y1="{y:.1f}" x2="{_LEFT + _PLOT_WIDTH}" y2="{y:.1f}" stroke="#dddddd"/>'
        yield _text(_LEFT - 6, y + 4, text, "end")


def _text(x: float, y: float, text: str, anchor: str = "start", full: str = "", weight: str = "normal") -> str:
    tooltip = f"<title>{escape(full)}</title>" if full != text and full else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-weight="{weight}">{escape(text)}{tooltip}</text>'


def _short(text: str, most: int) -> str:
    """Shortens a text in its middle: names of flows differ at both ends."""
    half = (most - 1) // 2
    return text if len(text) <= most else f"{text[:half]}…{text[-half:]}"


def _svg(parts: list[str], height: float) -> Svg:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height:.0f}" width="{_WIDTH}" height="{height:.0f}"'
    style = 'font-family="sans-serif" font-size="12" fill="#222222" stroke-linecap="round"'
    # White below everything: the drawing is read on pages with a dark background, too.
    return Svg(f'{head} {style}><rect width="100%" height="100%" fill="#ffffff"/>{"".join(parts)}</svg>')
