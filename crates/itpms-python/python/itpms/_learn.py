"""What drives at known pressures tell of a car."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import Any

from . import _itpms
from ._errors import SettingError
from ._pieces import CORNERS, TABLE, Pieces, pieces_of, rows_of
from ._progress import progress_bar
from ._signals import Signals, Where, map_file, rows_where
from ._tables import collected

Pressures = float | Mapping[str, float]


def learn(
    vehicle: _itpms.Vehicle,
    drives: Any,
    pressure_kpa: Pressures | Sequence[Pressures],
    trust_units: bool,
    dbc: str | PathLike[str] | None,
    signals: Signals,
    where: Where,
    progress: bool | None,
) -> _itpms.Learned:
    """What :meth:`itpms.Vehicle.learn` does, on the extension's side of things."""
    several = isinstance(drives, Sequence) and not isinstance(drives, str)
    logs = list(drives) if several else [drives]
    told = [pressure_kpa] if isinstance(pressure_kpa, (int, float, Mapping)) else list(pressure_kpa)
    if len(told) == 1:
        told = told * len(logs)
    if len(told) != len(logs):
        raise SettingError(
            f"pressure_kpa has {len(told)} entries for {len(logs)} drives, expected one for all or one for each, "
            "in the same order"
        )
    given = [_given(*drive, len(logs), signals is not None) for drive in zip(range(len(logs)), logs, told, strict=True)]
    with progress_bar(progress, "learning") as tell, map_file(signals) as path:
        return _itpms.learn(vehicle, given, trust_units, dbc, path, rows_where(where), tell)


def _given(number: int, drive: Any, pressures: Pressures, drives: int, mapped: bool) -> dict[str, Any]:
    known = pressures if isinstance(pressures, Mapping) else dict.fromkeys(CORNERS, pressures)
    stranger = next((name for name in known if name not in CORNERS), None)
    if stranger is not None:
        raise SettingError(f"pressure_kpa names {stranger!r}, expected corners: {', '.join(CORNERS)}")
    pressures_kpa = {name: float(value) for name, value in known.items()}
    if isinstance(drive, (str, PathLike)):
        return {"log": drive, "table": None, "pressures_kpa": pressures_kpa}
    name = TABLE if drives == 1 else f"table {number + 1}"
    if isinstance(drive, Iterator):
        raise SettingError(f"{name}: an iterator can be gone through once only, expected a path or a table")
    table = collected(drive)

    def once_more() -> Iterator[list[bytes | str]]:
        return iter(Pieces(name, pieces_of(name, table), mapped=mapped))

    names = Pieces(name, pieces_of(name, table), mapped=mapped).names
    return {"log": name, "table": (names, rows_of(table), once_more), "pressures_kpa": pressures_kpa}
