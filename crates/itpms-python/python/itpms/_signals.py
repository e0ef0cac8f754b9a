"""A map of signals that is a dict, as the file that the program reads; which rows, as the program takes it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ._errors import SettingError

Signals = str | PathLike[str] | Mapping[str, Any] | None
Where = str | Sequence[str] | Mapping[str, Any] | None


def rows_where(where: Where) -> list[str]:
    """What the rows are to have, as the program takes it: ``car=A``."""
    if isinstance(where, Mapping):
        return [f"{column}={value}" for column, value in where.items()]
    return [where] if isinstance(where, str) else list(where or [])


@contextmanager
def map_file(signals: Signals) -> Iterator[str | PathLike[str] | None]:
    """The path of a map: that which was given, or of a file with what the dict says, as long as it is needed."""
    if not isinstance(signals, Mapping):
        yield signals
        return
    lines = [f"{_text(column)} = {_entry(column, signal)}" for column, signal in signals.items()]
    with TemporaryDirectory(prefix="itpms-") as folder:
        path = Path(folder) / "signals.toml"
        path.write_text("\n".join(["[signals]", *lines]) + "\n", encoding="utf-8")
        yield path


def _entry(column: object, signal: object) -> str:
    if isinstance(signal, str):
        return _text(signal)
    if isinstance(signal, Mapping):
        return "{ " + ", ".join(f"{_text(key)} = {_value(column, value)}" for key, value in signal.items()) + " }"
    raise SettingError(
        f"signals[{column!r}] is {signal!r}, expected a name or a dict with signal and unit, or factor and offset"
    )


def _value(column: object, value: object) -> str:
    if isinstance(value, str):
        return _text(value)
    try:
        return repr(float(value))  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise SettingError(f"signals[{column!r}] has {value!r}, expected text or a number") from None


def _text(text: object) -> str:
    # What JSON escapes, TOML understands; what it need not escape stays.
    return json.dumps(str(text), ensure_ascii=False)
