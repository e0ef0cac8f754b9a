"""A car's parameters."""

from __future__ import annotations

import json
from os import PathLike
from typing import Any

from . import _itpms


class Vehicle:
    """A car as its vehicle file (TOML) describes it: checked, usable as it stands, unchanging.

    Made by :meth:`read`, :meth:`parse` or :meth:`paper`.
    """

    __slots__ = ("_about", "_inner")

    def __init__(self, inner: _itpms.Vehicle) -> None:
        self._inner = inner
        self._about: dict[str, Any] = json.loads(inner.json())

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Vehicle:
        """The car of a vehicle file.

        Raises:
            VehicleError: the file cannot be read, a key is missing or unknown, or a value is no car's.
        """
        return cls(_itpms.Vehicle.read(path))

    @classmethod
    def parse(cls, text: str) -> Vehicle:
        """The car that the text of a vehicle file describes.

        Raises:
            VehicleError: as :meth:`read`.
        """
        return cls(_itpms.Vehicle.parse(text))

    @classmethod
    def paper(cls) -> Vehicle:
        """The paper's simulated car (Table 2) at all four corners."""
        return cls(_itpms.Vehicle.paper())

    @property
    def name(self) -> str:
        """What people call it."""
        return str(self._about["name"])

    @property
    def id(self) -> str | None:
        """Which of the cars of that name it is, where its file says so."""
        found: str | None = self._about["id"]
        return found

    @property
    def wheelbase_m(self) -> float | None:
        """Distance between the axles in m."""
        found: float | None = self._about["wheelbase_m"]
        return found

    @property
    def corners(self) -> dict[str, dict[str, float]]:
        """Parameters by corner (``fl``, ``fr``, ``rl``, ``rr``) and name, with the units of the vehicle file."""
        return {corner: dict(values) for corner, values in self._about["corners"].items()}

    def to_toml(self) -> str:
        """The text of a vehicle file that reads back as this car."""
        return self._inner.to_toml()

    def write(self, path: str | PathLike[str]) -> None:
        """Writes a vehicle file, completely or not at all.

        Raises:
            OutputError: the file cannot be written.
        """
        self._inner.write(path)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Vehicle) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __repr__(self) -> str:
        return f"<itpms.Vehicle {self.name!r}, corners {' '.join(self.corners)}>"


def vehicle_of(given: Vehicle | str | PathLike[str]) -> Vehicle:
    """The car that was given, or that of a file."""
    return given if isinstance(given, Vehicle) else Vehicle.read(given)
