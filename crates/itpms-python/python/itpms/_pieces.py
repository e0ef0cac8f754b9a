"""A drive from a table, piece by piece: what the extension reads while the table stays where it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

import numpy.typing as npt

from ._errors import LogError
from ._itpms import COLUMNS
from ._tables import collected, columns_of, kind_of, numbers, shapeless

CORNERS = ("fl", "fr", "rl", "rr")
MEANT = frozenset(COLUMNS)
# What messages call a drive that has no name.
TABLE = "the table"
# Rows of a table that are held as numbers of our own at a time: a few hundred kilobytes of a whole car's.
PIECE_ROWS = 8192


def pieces_of(name: str, table: Any) -> Iterator[Any]:
    """A table in pieces of some rows, which lie where the table lies: nothing is copied. ``name`` is what messages call it."""
    kind = kind_of(table)
    if kind == "pandas":
        return _cut(len(table), lambda piece: table.iloc[piece])
    if kind == "polars":
        return _cut(len(table), lambda piece: table[piece])
    if kind == "pyarrow":
        # In the chunks that it has: what lies in two would have to be copied.
        batches = table.to_batches(max_chunksize=PIECE_ROWS) if hasattr(table, "to_batches") else ()
        return iter(batches) if batches else _cut(table.num_rows, lambda piece: table[piece])
    if kind != "numpy":
        return iter((table,))
    columns = columns_of(table)
    rows, first = None, ""
    for column, values in columns.items():
        if values.ndim != 1:
            raise shapeless(column, values)
        found = len(values)
        if rows is None:
            rows, first = found, column
        if found != rows:
            raise LogError(f"{name}: column {column} has {found} values, expected {rows} as in {first}")
    return _cut(rows or 0, lambda piece: {column: values[piece] for column, values in columns.items()})


def rows_of(table: Any) -> int | None:
    """How many rows a table has, where that is known."""
    kind = kind_of(table)
    if kind in ("pandas", "polars"):
        return len(table)
    if kind == "pyarrow":
        return int(table.num_rows)
    return len(table["time_s"]) if kind == "numpy" and "time_s" in table else None


def _cut(rows: int, cut: Callable[[slice], Any]) -> Iterator[Any]:
    """The pieces of so many rows; one without rows where there are none, which has the columns' names."""
    return (cut(slice(start, start + PIECE_ROWS)) for start in range(0, max(rows, 1), PIECE_ROWS))


class Pieces:
    """Tables with the same columns, in the order of time, as the extension takes them; ``name`` is what messages call the drive."""

    def __init__(self, name: str, tables: Iterator[Any], *, mapped: bool) -> None:
        first = next(tables, None)
        if first is None:
            raise LogError(f"{name}: there is no piece of a drive, expected one at least")
        self.name, self.names = name, list(columns_of(first))
        # What other names mean, their words say, of a speed beside columns of ours as well.
        ours = "speed_m_s" in self.names and any(name.endswith("_accel_m_s2") for name in self.names)
        self._tables, self._mapped = chain([first], tables), mapped or not ours

    def __iter__(self) -> Iterator[list[bytes | str]]:
        """Piece by piece, in the order of ``names``: numbers, or why a column holds none."""
        rows = 0
        for number, table in enumerate(self._tables, 1):
            columns = columns_of(table)
            if columns.keys() != set(self.names):
                odd = sorted(columns.keys() ^ set(self.names))
                raise LogError(
                    f"{self.name}: piece {number} differs in the column {odd[0]}, expected the columns of the first"
                )
            yield [_column(name, columns[name], rows, self._mapped) for name in self.names]
            rows += len(columns[self.names[0]]) if self.names else 0


def taken(name: str, drive: Any, *, mapped: bool) -> tuple[Pieces, int | None]:
    """A drive from a table, or from an iterator over tables, and how many rows it has, where that is known."""
    if isinstance(drive, Iterator):
        return Pieces(name, drive, mapped=mapped), None
    table = collected(drive)
    return Pieces(name, pieces_of(name, table), mapped=mapped), rows_of(table)


def _column(name: str, values: npt.NDArray[Any], before: int, mapped: bool) -> bytes | str:
    """A column for the extension, or why it has no numbers; ``before`` rows lie ahead of it."""
    if name in MEANT:
        return numbers(name, values, before).tobytes()
    if not mapped:
        # It means nothing; a misspelled name is seen all the same.
        return f"column {name} means nothing"
    try:
        return numbers(name, values, before).tobytes()
    except LogError as error:
        # Whether it should have some, the map says.
        return str(error)
