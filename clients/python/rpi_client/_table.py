"""Tables of the values of flows over time."""

from __future__ import annotations

import html
from bisect import bisect_left
from collections.abc import Iterable, Iterator
from dataclasses import is_dataclass
from enum import Enum
from itertools import islice
from typing import TYPE_CHECKING, Any, Literal

from ._drawing import Svg, draw_curves

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import polars as pl

#: What the values of a column are: truth values, integers, reals, or anything else, such as text.
Kind = Literal["bool", "int", "real", "other"]

#: Texts for reals that JSON cannot represent.
_NOT_FINITE = {"nan": float("nan"), "inf": float("inf"), "-inf": float("-inf")}


class Table:
    """Values of flows, a row for each time: ``name``, and the ``times`` in seconds.

    A column is a number, a truth value or a text: element 2 of the array ``joints`` is the column ``joints[2]``, the height of the pose
    ``goal`` is ``goal.position.z``. Values are in SI units, as in recordings. An absent value is None, in numpy masked (a real: NaN), in
    pandas missing, in polars null.
    """

    def __init__(self, name: str, times: list[float], columns: dict[str, list[Any]]) -> None:
        self.name = name
        self.times = times
        self._columns = {column: _reals(values) for column, values in columns.items()}

    @classmethod
    def from_rows(cls, name: str, rows: Iterable[tuple[float, dict[str, Any]]]) -> Table:
        """Makes a table from rows: the time of each in seconds, and its values, which may be nested. Columns are in the order in which
        they occur first."""
        times: list[float] = []
        columns: dict[str, list[Any]] = {}
        for count, (time, values) in enumerate(rows):
            times.append(time)
            for column, value in _leaves("", values, []):
                own = columns.setdefault(column, [])
                own.extend([None] * (count - len(own)))
                own.append(value)
        # An absent pose is one None, and no column of its own beside those of its parts.
        whole = {prefix for column in columns for prefix in _prefixes(column)}
        for column in [column for column, own in columns.items() if column in whole and own.count(None) == len(own)]:
            del columns[column]
        for own in columns.values():
            own.extend([None] * (len(times) - len(own)))
        return cls(name, times, columns)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns."""
        return tuple(self._columns)

    def __len__(self) -> int:
        return len(self.times)

    def __getitem__(self, column: str) -> list[Any]:
        """Returns the values of a column; ``KeyError`` if there is none of this name."""
        return list(self._columns[column])

    def kind(self, column: str) -> Kind:
        """Returns the kind of the values of a column; a column without any value counts as real."""
        kinds = {_kind(value) for value in self._columns[column] if value is not None}
        return kinds.pop() if len(kinds) == 1 else "other" if kinds else "real"

    def select(self, *flows: str) -> Table:
        """Returns the table with the columns of these flows alone, a flow by the name of a column or the part before a dot or an index
        (``joints`` for ``joints[0]``, ``joints[1]``, ...). ``KeyError`` for a flow without columns."""
        return Table(self.name, self.times, {column: self._columns[column] for flow in flows for column in self._of(flow)})

    def between(self, start: float, end: float) -> Table:
        """Returns the rows from ``start`` on and before ``end``, in seconds. The times must ascend, as those of recordings do."""
        rows = slice(bisect_left(self.times, start), bisect_left(self.times, end))
        return Table(self.name, self.times[rows], {column: values[rows] for column, values in self._columns.items()})

    def _of(self, flow: str) -> list[str]:
        found = [column for column in self._columns if column == flow or column.startswith((flow + ".", flow + "["))]
        if not found:
            raise KeyError(f"there is no {flow} in {self.name}; there are: {', '.join(self._columns)}")
        return found

    def array(self, flow: str) -> np.ndarray[Any, Any]:
        """Returns the values of a flow as an array of numpy: one axis for a number, rows by columns for an array or a pose (position,
        then orientation as x, y, z, w). Needs the extra ``numpy``."""
        import numpy as np

        columns = [self._array(column) for column in self._of(flow)]
        if columns and flow in self._columns:
            return columns[0]
        masked = any(isinstance(column, np.ma.MaskedArray) for column in columns)
        return np.ma.column_stack(columns) if masked else np.column_stack(columns)

    def to_numpy(self) -> dict[str, np.ndarray[Any, Any]]:
        """Returns the column ``time`` (s) and all others as arrays of numpy. Needs the extra ``numpy``."""
        import numpy as np

        return {"time": np.array(self.times), **{column: self._array(column) for column in self._columns}}

    def _array(self, column: str) -> np.ndarray[Any, Any]:
        import numpy as np

        values, kind = self._columns[column], self.kind(column)
        if kind == "real":
            return np.array(values, dtype=float)
        types = {"int": np.int64, "bool": np.bool_}
        absent = [value is None for value in values]
        if kind == "other" or not any(absent):
            return np.array(values, dtype=types.get(kind, object))
        known: np.ndarray[Any, Any] = np.array([0 if value is None else value for value in values], dtype=types[kind])
        return np.ma.MaskedArray(known, mask=absent)

    def to_pandas(self) -> pd.DataFrame:
        """Returns a data frame of pandas with the index ``time`` (s). Integers and truth values are of the types with missing values
        (``Int64``, ``boolean``) if some are absent. Needs the extra ``pandas``."""
        import pandas as pd

        types = {"int": "int64", "bool": "bool", "real": "float64", "other": "object"}
        absent = {"int": "Int64", "bool": "boolean"}
        index = pd.Index(self.times, dtype="float64", name="time")
        columns = {}
        for column, values in self._columns.items():
            kind = self.kind(column)
            dtype = absent.get(kind, types[kind]) if None in values else types[kind]
            columns[column] = pd.Series(values, index=index, dtype=dtype)
        return pd.DataFrame(columns, index=index)

    def to_polars(self) -> pl.DataFrame:
        """Returns a data frame of polars with the column ``time`` (s). Needs the extra ``polars``."""
        import polars as pl

        types = {"int": pl.Int64, "bool": pl.Boolean, "real": pl.Float64, "other": pl.Object}
        columns = [pl.Series("time", self.times, dtype=pl.Float64)]
        for column, values in self._columns.items():
            texts = all(value is None or isinstance(value, str) for value in values)
            kind = self.kind(column)
            columns.append(pl.Series(column, values, dtype=pl.String if kind == "other" and texts else types[kind]))
        return pl.DataFrame(columns)

    def plot(self, *flows: str, title: str | None = None) -> Svg:
        """Draws these flows over time; all columns with numbers unless given. Absent values and NaN are gaps. Truth values are 0 and 1."""
        shown = self.select(*flows) if flows else self
        curves = {column: values for column, values in shown._columns.items() if shown.kind(column) != "other"}
        if not flows:
            curves.pop("cycle", None)
        return draw_curves(self.name if title is None else title, self.times, curves)

    def __repr__(self) -> str:
        return f"<Table {self.name}: {len(self)} rows, {len(self._columns)} columns>"

    def _repr_html_(self) -> str:
        """Shows the first and the last rows in Jupyter."""
        head = "".join(f"<th>{html.escape(column)}</th>" for column in ("time", *self._columns))
        few = len(self) <= 2 * _SHOWN
        first = range(len(self) if few else _SHOWN)
        last = [] if few else range(len(self) - _SHOWN, len(self))
        dots = "" if few else f"<tr>{'<td>...</td>' * (1 + len(self._columns))}</tr>"
        rows = "".join(map(self._row, first)) + dots + "".join(map(self._row, last))
        return f"<p>{html.escape(self.name)}: {len(self)} rows</p><table><tr>{head}</tr>{rows}</table>"

    def _row(self, row: int) -> str:
        cells = (self.times[row], *(values[row] for values in self._columns.values()))
        return "<tr>" + "".join(f"<td>{html.escape(_cell(value))}</td>" for value in cells) + "</tr>"


#: Number of rows that Jupyter shows from the beginning and the end of a table.
_SHOWN = 5


def _prefixes(column: str) -> Iterator[str]:
    """Yields the names of the values that a column is a part of: ``pose`` and ``pose.position`` for ``pose.position.x``."""
    return (column[:k] for k, letter in enumerate(column) if letter in ".[" and k > 0)


def _cell(value: Any) -> str:
    return "" if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)


def _kind(value: Any) -> Kind:
    if isinstance(value, bool):
        return "bool"
    return "int" if isinstance(value, int) else "real" if isinstance(value, float) else "other"


def _reals(values: list[Any]) -> list[Any]:
    """Replaces the texts of reals that JSON cannot represent, if all other values are reals."""
    rest = (value for value in values if value is not None and not isinstance(value, float))
    few = list(islice((value for value in rest if not (isinstance(value, str) and value in _NOT_FINITE)), 1))
    if few or not any(isinstance(value, str) for value in values):
        return values
    return [_NOT_FINITE[value] if isinstance(value, str) else value for value in values]


#: Types of values that are a column each.
_SIMPLE = (float, int, bool, str, type(None))


def _leaves(name: str, value: Any, leaves: list[tuple[str, Any]]) -> list[tuple[str, Any]]:
    """Appends the single values in a value, each with the name of its column, and returns the list."""
    # The order of the cases is that of their frequency: this runs for each number of a recording.
    if type(value) in _SIMPLE:
        leaves.append((name, value))
    elif isinstance(value, dict):
        for key, part in value.items():
            _leaves(f"{name}.{key}" if name else key, part, leaves)
    elif hasattr(value, "_asdict"):
        _leaves(name, value._asdict(), leaves)
    elif isinstance(value, (list, tuple)):
        for k, part in enumerate(value):
            _leaves(f"{name}[{k}]", part, leaves)
    elif isinstance(value, Enum):
        leaves.append((name, value.name))
    elif is_dataclass(value):
        _leaves(name, vars(value), leaves)
    else:
        leaves.append((name, value))
    return leaves
