"""Tables in and out: pandas, polars, pyarrow, or a dict of arrays. None of the three is needed."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ._errors import LogError, SettingError

Kind = Literal["pandas", "polars", "pyarrow", "numpy", "dict"]
Array = npt.NDArray[Any]
Columns = dict[str, Array]


def kind_of(table: object) -> Kind | None:
    """Which of the libraries a table is of; None if it is no table."""
    # A library that was never imported has made no table.
    for name, classes in (
        ("pandas", ("DataFrame",)),
        ("polars", ("DataFrame", "LazyFrame")),
        ("pyarrow", ("Table", "RecordBatch")),
    ):
        module = sys.modules.get(name)
        if module is not None and any(isinstance(table, getattr(module, each)) for each in classes):
            return name  # type: ignore[return-value]
    return "numpy" if isinstance(table, Mapping) else None


def collected(table: Any) -> Any:
    """A lazy frame of polars as the frame that it stands for; any other table as it is."""
    return table.collect() if kind_of(table) == "polars" and hasattr(table, "collect") else table


def columns_of(table: Any) -> Columns:
    """The columns of a table as arrays, by name, where they are numbers or times."""
    kind = kind_of(table)
    if kind == "pandas":
        return _of_pandas(table)
    if kind == "polars":
        frame = collected(table)
        return {str(name): frame.get_column(name).to_numpy() for name in frame.columns}
    if kind == "pyarrow":
        # A batch's columns, unlike a table's, are copied only where one says so.
        options = {} if hasattr(table, "combine_chunks") else {"zero_copy_only": False}
        return {str(name): table.column(name).to_numpy(**options) for name in table.schema.names}
    if kind == "numpy":
        # Not as plain arrays: a mask says which values are missing.
        return {str(name): np.asanyarray(values) for name, values in table.items()}
    found = type(table).__name__
    raise SettingError(
        f"the drive is a {found}, expected a path, a pandas or polars data frame, a pyarrow table or a dict of arrays"
    )


def _of_pandas(frame: Any) -> Columns:
    columns = {str(name): frame[name].to_numpy() for name in frame.columns}
    # A frame that is indexed by time needs no column for it.
    if "time_s" not in columns and frame.index.dtype.kind in "mM":
        columns["time_s"] = frame.index.to_numpy()
    return columns


def numbers(name: str, values: Array, before: int = 0) -> Array:
    """A column as float64; missing values are NaN, times are seconds.

    A datetime counts from 1970-01-01 UTC (without a time zone it is taken to be UTC), a timedelta from nothing. In messages the first
    row is the one after ``before``.
    """
    if values.ndim != 1:
        raise shapeless(name, values)
    if isinstance(values, np.ma.MaskedArray):
        hidden = np.ma.getmaskarray(values)
        plain = np.asarray(values.data).copy()
        if plain.dtype.kind == "O":
            plain[hidden] = None
        return np.where(hidden, np.nan, numbers(name, plain, before))
    if values.dtype.kind in "mM":
        missing = np.isnat(values)
        unit = "datetime64[ns]" if values.dtype.kind == "M" else "timedelta64[ns]"
        whole = values.astype(unit).astype(np.int64)
        seconds = (whole // 1_000_000_000) + (whole % 1_000_000_000) / 1e9
        return np.where(missing, np.nan, seconds)
    try:
        return np.ascontiguousarray(values, dtype="<f8")
    except (TypeError, ValueError):
        # Objects: a None, or an NA of pandas, is a missing value.
        pass
    return np.array([_number(name, row, value) for row, value in enumerate(values, before + 1)], dtype="<f8")


def shapeless(name: str, values: Array) -> LogError:
    """What is said of a column that is none."""
    return LogError(f"column {name}: found an array of shape {values.shape}, expected one value per row")


def _number(name: str, row: int, value: Any) -> float:
    if value is None or type(value).__name__ == "NAType":
        return float("nan")
    if type(value).__name__ in ("Timestamp", "datetime"):
        return float(value.timestamp())
    if hasattr(value, "total_seconds"):
        return float(value.total_seconds())
    try:
        return float(value)
    except (TypeError, ValueError):
        found = repr(str(value)[:40])
        raise LogError(
            f"row {row}, column {name}: found {found}, expected a number, or NaN or nothing where it is missing"
        ) from None


def unpacked(columns: Sequence[tuple[str, bytes]], words: Sequence[tuple[str, list[str]]] = ()) -> Columns:
    """Columns from the extension, in the order of the command's files."""
    arrays: Columns = {name: np.frombuffer(values, dtype="<f8") for name, values in columns}
    for name, values in arrays.items():
        if name.endswith("_valid"):
            arrays[name] = values != 0.0
    ordered: Columns = {}
    labels = dict(words)
    for name, values in arrays.items():
        ordered[name] = values
        for number, word in (
            ("_valid", "_warning"),
            ("_change_sd_kpa", "_level"),
            ("_lost_sd_kpa", "_state"),
        ):
            if name.endswith(number):
                label = name.removesuffix(number) + word
                ordered[label] = np.array(labels[label], dtype=object)
    return ordered


def table_of(columns: Columns, kind: Kind) -> Any:
    """Columns as a table of one of the libraries, or as the dict they are."""
    if kind in ("numpy", "dict"):
        return dict(columns)
    module = _library(kind)
    # Arrays over the extension's bytes are read-only; a frame is the user's own.
    own = {name: np.array(values) for name, values in columns.items()}
    if kind == "pyarrow":
        return module.table(own)
    return module.DataFrame(own)


def _library(kind: Kind) -> Any:
    import importlib

    try:
        return importlib.import_module(kind)
    except ImportError:
        raise SettingError(
            f"frame={kind!r}: {kind} is not installed, expected one of pandas, polars, pyarrow, numpy, dict"
        ) from None


def usual() -> Kind:
    """What a result is where the input was no table: pandas, polars, or else a dict."""
    import importlib.util

    for kind in ("pandas", "polars"):
        if importlib.util.find_spec(kind) is not None:
            return kind
    return "numpy"
