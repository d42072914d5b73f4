"""Single inputs and outputs of digital and analogue devices, as the options of chunks name them: ``torch.set[0]``, ``torch.get[2]``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

from ._text import identifier

_FORM = re.compile(r"(.*)\.(get|set)\[(0|[1-9][0-9]{0,2})\]", re.DOTALL)


class Terminal(NamedTuple):
    """An input (``get``) or output (``set``) of a device, counted from 0."""

    device: str
    port: str
    number: int

    def present_value(self, is_digital: bool) -> str:
        """Returns the expression for the present value of an output."""
        kind = "Bool" if is_digital else "Real"
        return f'IO::Out{kind}Sensor<<DeviceID: "{self.device}", Port: {self.number}>>()'


def terminal_of(name: str) -> Terminal | None:
    """Returns the terminal with this name; None for the name of another port."""
    form = _FORM.fullmatch(name)
    return None if form is None else Terminal(identifier(form[1]), form[2], int(form[3]))


def terminals_of(device: str, port: str, names: Iterable[str]) -> list[int]:
    """Returns the indices of the terminals of a device among these names, in order."""
    terminals = (terminal_of(name) for name in names)
    return sorted({t.number for t in terminals if t is not None and (t.device, t.port) == (device, port)})


def check_single_terminals(device: str, names: Iterable[str]) -> None:
    """Raises ``ValueError`` for a name of all inputs or outputs of a device with terminals: a stream has one value in a row for each of them."""
    for name in names:
        port = name.removeprefix(f"{device}.")
        if port in {"get", "set"} and port != name:
            kind, option = ("inputs", "observe") if port == "get" else ("outputs", "channels")
            raise ValueError(f"{option}: {name} is all {kind} of {device}; name them one by one, such as {name}[0]")


def type_with_terminals(device: str, outputs: Mapping[str, str], inputs: Iterable[str]) -> str:
    """Returns the type of a device in a program that drives these outputs, with their units, and reads these inputs, with the numbers of both.
    Without outputs it is digital. ``ValueError`` if outputs of both types are named, or if one before the last is not: a program drives all up to
    the last one together."""
    check_single_terminals(device, [*outputs, *inputs])
    driven = terminals_of(device, "set", outputs)
    missing = sorted(set(range(driven[-1])) - set(driven)) if driven else []
    if missing:
        raise ValueError(f"channels: {device}.set[{missing[0]}] is needed, too: outputs 0 to {driven[-1]} are driven together")
    digital = {outputs[f"{device}.set[{index}]"] == "bool" for index in driven} or {True}
    if len(digital) > 1:
        raise ValueError(f"channels: {device} has digital and analogue outputs; a stream drives those of one type")
    read = terminals_of(device, "get", inputs)
    name = "DigitalIo" if digital == {True} else "AnalogueIo"
    return f"{name}<<{read[-1] + 1 if read else 0}, {len(driven)}>>"
