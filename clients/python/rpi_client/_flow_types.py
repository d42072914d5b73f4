"""Types of flows, and the texts by which the server sends and receives values (the notation of nets)."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol, Union, cast

from ._values import Pose, Rotation, Twist, Vector, Wrench

#: Value of a flow. Arrays are lists, structs are dictionaries, an absent flow is None. A ``Time`` is an int: ns since the Unix epoch.
Value = Union[bool, int, float, Vector, Rotation, Pose, Twist, Wrench, Enum, "list[Value]", "dict[str, Value]", None]


class SupportsToList(Protocol):
    """An array or number of numpy."""

    def tolist(self) -> Any: ...


#: Value for an input: numbers, spatial values and enum members, lists and arrays of numpy for arrays, mappings for structs.
InputValue = Union[
    bool, int, float, Vector, Rotation, Pose, Twist, Wrench, Enum, SupportsToList, "Sequence[InputValue]", "Mapping[str, InputValue]"
]


@dataclass(frozen=True)
class FlowType:
    """Type of a flow: ``scalar`` (``bool``, ``int``, ``real``, ``Time``, ``Vector``, ``Rotation``, ``Pose``, ``Twist``, ``Wrench``), the
    ``shape`` if it is an array or matrix, and the ``enum`` whose member the value is, if one was given for the flow."""

    scalar: str
    shape: tuple[int, ...] = ()
    enum: type[Enum] | None = None

    @classmethod
    def parse(cls, text: str, enum: type[Enum] | None = None) -> FlowType:
        """Parses a type as the server writes it, such as ``real^3^2``."""
        scalar, *shape = text.split("^")
        return cls(scalar, tuple(int(length) for length in shape), enum)

    def decode(self, text: str) -> Value:
        """Parses the text of a value. A type that a newer server may send is returned as the text of its value."""
        if self.shape:
            elements = [_scalar(self.scalar, element) for element in _tree(text)]
            return _arranged([_member(element, self.enum) for element in elements], self.shape)
        value = _scalar(self.scalar, text if self.scalar in _WORDS else _tree(text))
        return _member(value, self.enum)

    def encode(self, value: Any) -> str:
        """Returns the text of a value. ``TypeError`` if it has another type, ``ValueError`` if it has another shape or is not finite."""
        if not self.shape:
            return _encoded(self.scalar, value)
        elements = [value]
        for length in self.shape:
            elements = [part for element in elements for part in _items(element, length)]
        if self.scalar == "real" and _PLAIN.issuperset(map(type, elements)) and all(map(math.isfinite, elements)):
            # Chunks of policies have hundreds of numbers.
            return f"[{','.join(map(repr, map(float, elements)))}]"
        return f"[{','.join(_encoded(self.scalar, element) for element in elements)}]"


#: A key, a word or a number in the text of a value.
_WORD = re.compile(r"[^\s\[\]{}:,]+")
#: Types of numbers that need no conversion.
_PLAIN = {float, int}
#: Types whose text is one word.
_WORDS = ("bool", "int", "real", "Time")
_LARGEST_INT = 2**63


def _scalar(kind: str, tree: Any) -> Value:
    """Returns a value from the parsed text of a scalar."""
    if kind == "bool":
        return tree in ("true", True)
    if kind == "int":
        return int(tree)
    if kind == "real":
        return float(tree)
    if kind == "Time":
        return _nanoseconds(str(tree))
    return _SPATIAL[kind](tree) if kind in _SPATIAL else cast(Value, tree)


def _vector(tree: Any) -> Vector:
    return Vector(float(tree["x"]), float(tree["y"]), float(tree["z"]))


def _rotation(tree: Any) -> Rotation:
    return Rotation.from_euler(float(tree["a"]), float(tree["b"]), float(tree["c"]))


_SPATIAL: dict[str, Callable[[Any], Value]] = {
    "Vector": _vector,
    "Rotation": _rotation,
    "Pose": lambda tree: Pose(_vector(tree["pos"]), _rotation(tree["rot"])),
    "Twist": lambda tree: Twist(_vector(tree["vel"]), _vector(tree["rot"])),
    "Wrench": lambda tree: Wrench(_vector(tree["force"]), _vector(tree["torque"])),
}


def _tree(text: str) -> Any:
    """Parses objects and lists: JSON, but for keys without quotes and words. Words and numbers become strings."""
    if '"' in text or "\\" in text:
        return json.loads(_WORD.sub(lambda word: json.dumps(word[0]), text))
    # The usual case, without a call for each word.
    return json.loads(_WORD.sub(r'"\g<0>"', text))


def _nanoseconds(text: str) -> int:
    """Parses milliseconds with up to six digits after the point."""
    whole, _, part = text.partition(".")
    return int(f"{whole}{part:0<6}")


def _member(value: Value, enum: type[Enum] | None) -> Value:
    """Returns the member of the enum with this value; the value itself if there is none."""
    if enum is None:
        return value
    found = [member for member in enum if member.value == value]
    return found[0] if found else value


def _arranged(elements: list[Value], shape: tuple[int, ...]) -> Value:
    """Arranges the elements of an array, row by row, into lists of this shape."""
    for length in reversed(shape[1:]):
        elements = [elements[k : k + length] for k in range(0, len(elements), length)]
    return elements


def _encoded(kind: str, value: Any) -> str:
    """Returns the text of a scalar."""
    if isinstance(value, Enum):
        value = value.value
    if hasattr(value, "tolist"):
        value = value.tolist()
    if kind == "bool" and isinstance(value, bool):
        return "true" if value else "false"
    is_int = isinstance(value, int) and not isinstance(value, bool)
    if kind == "int" and is_int:
        if not -_LARGEST_INT <= value < _LARGEST_INT:
            raise ValueError(f"{value} does not fit into 64 bits")
        return str(value)
    if kind == "Time" and is_int:
        whole, part = divmod(abs(value), 1_000_000)
        return f"{'-' if value < 0 else ''}{whole}.{part:06}"
    if kind == "real" and (is_int or isinstance(value, float)):
        return _real(value)
    if kind in _ENCODERS:
        return _ENCODERS[kind](value)
    raise TypeError(f"{value!r} is not of type {kind}")


def _real(value: Any) -> str:
    # Set-points follow from inputs: one that is not finite is a mistake of the caller far more often than it is meant.
    if not math.isfinite(value):
        raise ValueError(f"{value} is not a finite number")
    return repr(float(value))


def _fields(names: str, values: Sequence[Any]) -> str:
    return "{" + ",".join(f"{name}:{_real(value)}" for name, value in zip(names, values, strict=True)) + "}"


def _vector_text(value: Any) -> str:
    return _fields("xyz", _items(value, 3))


def _rotation_text(value: Any) -> str:
    return _fields("abc", Rotation(*_items(value, 4)).euler())


def _pair(kind: type, names: tuple[str, str], second: Callable[[Any], str]) -> Callable[[Any], str]:
    """Returns the encoder of a type with two parts."""

    def encode(value: Any) -> str:
        if not isinstance(value, kind):
            raise TypeError(f"{value!r} is not a {kind.__name__}")
        one, other = vars(value).values()
        return f"{{{names[0]}:{_vector_text(one)},{names[1]}:{second(other)}}}"

    return encode


_ENCODERS: dict[str, Callable[[Any], str]] = {
    "Vector": _vector_text,
    "Rotation": _rotation_text,
    "Pose": _pair(Pose, ("pos", "rot"), _rotation_text),
    "Twist": _pair(Twist, ("vel", "rot"), _vector_text),
    "Wrench": _pair(Wrench, ("force", "torque"), _vector_text),
}


def _items(value: Any, length: int) -> Sequence[Any]:
    """Returns the elements of a sequence or an array of numpy."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (str, bytes)) or not isinstance(value, Sequence):
        raise TypeError(f"{value!r} is not a sequence")
    if len(value) != length:
        raise ValueError(f"{length} elements are needed, and {value!r} has {len(value)}")
    return value
