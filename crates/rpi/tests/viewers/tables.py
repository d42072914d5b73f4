"""Compares tables in Parquet and Arrow with the same table in CSV.

Usage: tables.py CSV PARQUET ARROW. Needs the package pyarrow.
"""

import csv
import re
import sys

import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet


def expected(file):
    """Columns of a CSV file by name, as texts, and their units."""
    with open(file, newline="") as stream:
        names, *rows = csv.reader(stream)
    units, columns = {}, {}
    for index, name in enumerate(names):
        plain, unit = re.fullmatch(r"(.*?)(?: \[([^\]0-9][^\]]*)\])?", name).groups()
        units[plain] = unit
        columns[plain] = [row[index] for row in rows]
    return columns, units


def flat(table):
    """Columns of a table by the names in CSV, with their fields: each element of a list is a column."""
    for field in table.schema:
        name = (field.metadata or {}).get(b"name", field.name.encode()).decode()
        assert field.name == name.replace(".", "/"), (field.name, name)
        values = table[field.name].to_pylist()
        if pa.types.is_fixed_size_list(field.type):
            for k in range(field.type.list_size):
                yield f"{name}[{k}]", field, field.type.value_type, [v and v[k] for v in values]
        else:
            yield name, field, field.type, values


PARSERS = {
    pa.float64(): float,
    pa.int64(): int,
    pa.bool_(): {"true": True, "false": False}.__getitem__,
}


def check(table, columns, units):
    metadata = {key.decode(): value.decode() for key, value in table.schema.metadata.items()}
    assert metadata["tick_ns"] == "1000000" and metadata["program"].endswith(".rpi"), metadata
    seen, lists = set(), 0
    for name, field, kind, values in flat(table):
        lists += pa.types.is_fixed_size_list(field.type)
        assert name in columns, f"{name} is not in the CSV file: {sorted(columns)}"
        texts, parse = columns[name], PARSERS[kind]
        assert values == [parse(text) if text else None for text in texts], name
        own = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
        assert own.get("unit") == units[name], (name, own)
        if name not in ("tick", "time"):
            assert name.startswith(own["source"] + "/"), (name, own)
        seen.add(name)
    assert seen == set(columns), set(columns) - seen
    assert lists > 0, "the joints of the arm are a list"
    return len(seen)


columns, units = expected(sys.argv[1])
counts = [
    check(pa.parquet.read_table(sys.argv[2]), columns, units),
    check(pa.ipc.open_file(sys.argv[3]).read_all(), columns, units),
]
print(f"{counts[0]} columns with {len(columns['tick'])} rows are the same in CSV, Parquet and Arrow")
