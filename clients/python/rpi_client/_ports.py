"""Inputs and exports of a command. The server splits structs and arrays of programs into ports such as ``rows[1].mass``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import Enum
from typing import Any, Union, cast

from ._flow_types import FlowType, Value, _items

#: Ports as nested as the values: a port by its key, a list of an array, a dictionary of a struct.
_Tree = Union[str, "list[_Tree]", "dict[str, _Tree]"]


class Ports:
    """The ports of a command in one direction: ``types`` has the type of each by its key, ``units`` the units of those that have one."""

    def __init__(self, described: list[dict[str, str]], enums: Mapping[str, type[Enum]]) -> None:
        entries = ((port["key"], port["type"]) for port in described)
        self.types = {key: FlowType.parse(text, _enum_of(key, enums)) for key, text in entries}
        self.units = {port["key"]: port["unit"] for port in described if port.get("unit")}
        self._tree = _tree_of(list(self.types))

    def decode(self, texts: Mapping[str, str]) -> dict[str, Value]:
        """Returns the values of ports by key; a port that was not described is left out."""
        return {key: self.types[key].decode(text) for key, text in texts.items() if key in self.types}

    def nest(self, values: Mapping[str, Value]) -> dict[str, Value]:
        """Returns the values of the flows by name, from those of their ports; without flows that have no value in any port."""
        nested = {name: self._nested(tree, values) for name, tree in self._tree.items()}
        return {name: value for name, value in nested.items() if not _is_absent(value)}

    def _nested(self, tree: _Tree, values: Mapping[str, Value]) -> Value:
        if isinstance(tree, list):
            return [self._nested(part, values) for part in tree]
        if isinstance(tree, dict):
            return {name: self._nested(part, values) for name, part in tree.items()}
        return values.get(tree)

    def has(self, name: str) -> bool:
        """Returns whether this is the name of a flow, or of a part of one."""
        return any(key == name or key.startswith((f"{name}.", f"{name}[")) for key in self.types)

    @staticmethod
    def find(name: str, values: Mapping[str, Value]) -> Value:
        """Returns the value of a flow, or of a part of one, from nested values; None if it has none."""
        if name in values:
            return values[name]
        node: Any = values
        for step in _steps(name):
            if isinstance(node, Mapping):
                node = node.get(step)
            elif isinstance(node, list) and isinstance(step, int) and step < len(node):
                node = node[step]
            else:
                return None
        return cast(Value, node)

    def encode(self, values: Mapping[str, Any]) -> dict[str, str]:
        """Returns the texts of the ports by key. ``ValueError`` for an unknown name; otherwise as :meth:`FlowType.encode`."""
        texts: dict[str, str] = {}
        for name, value in values.items():
            tree = name if name in self.types else self._tree.get(name)
            if tree is None:
                known = ", ".join(self._tree) or "none"
                raise ValueError(f"there is no input {name}; there are: {known}")
            self._encode(name, tree, value, texts)
        return texts

    def _encode(self, name: str, tree: _Tree, value: Any, texts: dict[str, str]) -> None:
        try:
            if isinstance(tree, str):
                texts[tree] = self.types[tree].encode(value)
                return
            parts = _parts(tree, value)
        except (TypeError, ValueError) as error:
            raise type(error)(f"{name}: {error}") from None
        for step, part, own in parts:
            self._encode(name + step, part, own, texts)


def _parts(tree: list[_Tree] | dict[str, _Tree], value: Any) -> list[tuple[str, _Tree, Any]]:
    """Returns the parts of an array or a struct: the step in the name, the ports and the value of each."""
    if isinstance(tree, list):
        pairs = zip(tree, _items(value, len(tree)), strict=True)
        return [(f"[{k}]", part, own) for k, (part, own) in enumerate(pairs)]
    if not isinstance(value, Mapping):
        raise TypeError(f"{value!r} is not a mapping")
    unknown = sorted(set(value) - set(tree))
    if unknown:
        raise ValueError(f"there is no field {unknown[0]}; there are: {', '.join(tree)}")
    return [(f".{name}", tree[name], own) for name, own in value.items()]


def _enum_of(key: str, enums: Mapping[str, type[Enum]]) -> type[Enum] | None:
    """Returns the enum for a key; one for ``row.mode`` is also that of ``row[3].mode``."""
    return enums.get(key) or enums.get(re.sub(r"\[\d+\]", "", key))


def _is_absent(value: Value) -> bool:
    if isinstance(value, list):
        return all(_is_absent(part) for part in value)
    if isinstance(value, dict):
        return all(_is_absent(part) for part in value.values())
    return value is None


def _tree_of(keys: list[str]) -> dict[str, _Tree]:
    """Nests keys by their dots and indices. A key that contradicts another one, as those of nets may, stays as it is: that of a flow
    inside a call (``level.inner``) beside that of the result of the call (``level``)."""
    root: dict[Any, Any] = {}
    known = set(keys)
    for key in keys:
        *path, last = [key] if _is_within(key, known) else _steps(key)
        node: Any = root
        for step in path:
            node = node.setdefault(step, {}) if isinstance(node, dict) else None
        if isinstance(node, dict) and last not in node:
            node[last] = key
        else:
            root[key] = key
    return {name: _listed(tree) for name, tree in root.items()}


def _is_within(key: str, known: set[str]) -> bool:
    """Returns whether the beginning of a key, up to a dot or an index, is a key itself."""
    return any(key[:k] in known for k, sign in enumerate(key) if sign in ".[")


def _steps(key: str) -> list[str | int]:
    """Splits ``rows[1].mass`` into ``rows``, 1, ``mass``."""
    if not re.fullmatch(r"[^.\[\]]+(\[\d{1,6}\]|\.[^.\[\]]+)*", key):
        return [key]
    return [int(index) if index else name for index, name in re.findall(r"\[(\d+)\]|([^.\[\]]+)", key)]


def _listed(tree: Any) -> _Tree:
    """Makes a list of each dictionary with the keys 0 to n - 1."""
    if isinstance(tree, str):
        return tree
    if sorted(tree, key=str) == sorted(range(len(tree)), key=str):
        return [_listed(tree[k]) for k in range(len(tree))]
    return {str(name): _listed(part) for name, part in tree.items()}
