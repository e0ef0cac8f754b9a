"""What drives at known pressures tell of a car."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

from . import _itpms
from ._errors import SettingError
from ._files import write
from ._pieces import CORNERS, TABLE, Pieces, pieces_of
from ._tables import collected

if TYPE_CHECKING:
    from ._vehicle import Vehicle

Pressures = float | Mapping[str, float]


class Learned:
    """What drives have told of a car. Made by :meth:`itpms.Vehicle.learn`.

    Attributes:
        vehicle: The car with what was learned in the place of what was said of it: the one to go on with.
        corners: By corner (``fl``, ``fr``, ``rl``, ``rr``) and parameter (``unsprung_mass_kg``, ``tire_n_per_m``,
            ``stiffness_over_mass_per_s2``, ``damping_n_s_per_m``, ``spring_n_per_m``, ``friction_n``) what it was and is:
            ``before``, ``before_sd``, ``after``, ``after_sd``, and whether the drives have told it (``learned``). Beside them
            ``uncalibrated_pressure_sd_kpa``, the standard deviation of a pressure without a calibration.
        slope_over_file: The same of how stiffness goes with pressure, over what was said of it.
        unknown: What no drive has told, and what none can tell, a sentence each.
        concerns: What should be known before believing it, a sentence each.
    """

    def __init__(self, inner: _itpms.Learned, vehicle: Vehicle) -> None:
        self._inner = inner
        document = json.loads(inner.document())
        self.vehicle = vehicle
        self.corners: dict[str, dict[str, Any]] = document["corners"]
        self.slope_over_file: dict[str, Any] = document["slope_over_file"]
        self.unknown: list[str] = document["unknown"]
        self.concerns: list[str] = document["concerns"]

    def to_toml(self, began_with: str | None = None) -> str:
        """The vehicle file, with a comment on where each value comes from: that of ``itpms vehicle learn -o``.

        Args:
            began_with: What the comment calls the file that it began with; the car's name unless given.
        """
        return self._inner.to_toml(self.vehicle.name if began_with is None else began_with)

    def write(self, path: str | PathLike[str], began_with: str | None = None) -> None:
        """Writes that file, completely or not at all.

        Raises:
            OutputError: the file cannot be written.
        """
        write(path, self.to_toml(began_with).encode())

    def __repr__(self) -> str:
        lines = [f"<itpms.Learned {self.vehicle.name!r}"]
        for name, corner in self.corners.items():
            told = [key for key, value in corner.items() if isinstance(value, dict) and value["learned"]]
            lines.append(f"  {name}  {', '.join(told) or 'nothing'}")
        return "\n".join(lines) + ">"


def learn(
    vehicle: _itpms.Vehicle,
    drives: Any,
    pressure_kpa: Pressures | Sequence[Pressures],
    trust_units: bool,
    dbc: str | PathLike[str] | None,
    signals: str | PathLike[str] | None,
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
    return _itpms.learn(vehicle, given, trust_units, dbc, signals)


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
    return {"log": name, "table": (names, once_more), "pressures_kpa": pressures_kpa}
