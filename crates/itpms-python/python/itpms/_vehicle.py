"""A car's parameters."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from typing import Any

from . import _itpms
from ._check import Checked, check
from ._itpms import write
from ._learn import Pressures, learn
from ._signals import Signals, Where


class Fixed(dict[str, Any]):
    """A dict to read: to write into it raises. Its copies (``dict``, ``copy.deepcopy``, pickle) are plain ones."""

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise TypeError(
            "a Vehicle does not change: put the value into its text, Vehicle.parse(car.to_toml().replace(...))"
        )

    __setitem__ = __delitem__ = __ior__ = update = setdefault = pop = popitem = clear = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return dict, (dict(self),)


class Vehicle:
    """A car as its vehicle file (TOML) describes it: checked, usable as it stands, unchanging.

    Made by :meth:`read`, :meth:`parse`, :meth:`typical` or :meth:`paper`.
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

    @classmethod
    def typical(
        cls,
        mass_kg: float,
        front_share: float,
        tire: str | tuple[str, str],
        *,
        car_class: str | None = None,
        placard_kpa: float | tuple[float, float] = 240.0,
        wheelbase_m: float | None = None,
        name: str | None = None,
    ) -> Vehicle:
        """A car of typical values, each with its standard deviation: that of ``itpms vehicle init``.

        Args:
            mass_kg: Ready to drive, from the registration papers.
            front_share: Share of it that rests on the front axle.
            tire: Size as on the sidewall, such as ``205/55R16``; where the axles differ, a tuple of front and rear.
            car_class: ``compact``, ``sedan`` (unless given), ``suv`` or ``van``.
            placard_kpa: Pressure on the placard, gauge; where the axles differ, a tuple of front and rear.
            wheelbase_m: Distance between the axles; that of other cars of the class unless given.
            name: What the car is called.

        Raises:
            SettingError: no car has such values.
        """
        return cls(_itpms.Vehicle.typical(mass_kg, front_share, tire, car_class, placard_kpa, wheelbase_m, name))

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
        """Parameters by corner (``fl``, ``fr``, ``rl``, ``rr``) and name, with the units of the vehicle file; to read, as the car is."""
        return Fixed({corner: Fixed(values) for corner, values in self._about["corners"].items()})

    def learn(
        self,
        drives: Any,
        pressure_kpa: Pressures | Sequence[Pressures],
        *,
        trust_units: bool = False,
        dbc: str | PathLike[str] | None = None,
        signals: Signals = None,
        where: Where = None,
        progress: bool | None = None,
    ) -> Learned:
        """Learns what drives at known pressures tell of the car, as ``itpms vehicle learn`` does; the car itself stays as it is.

        Every parameter is weighed against the standard deviation that the vehicle file gives it. Ten minutes at an even pace teach
        most; a second drive with the same tires a quarter lower teaches how stiffness goes with pressure. Each drive is gone through
        twice. The interpreter's lock is free meanwhile; Ctrl-C ends it.

        Args:
            drives: A drive or a list of them, each a path or a table as for :func:`itpms.estimate`.
            pressure_kpa: What the tires had while driving, kPa gauge: a number for all, or a dict by corner
                (``fl``, ``fr``, ``rl``, ``rr``); with several drives one for all, or a list of one for each.
            trust_units: As in :func:`itpms.estimate`, like the following.
            dbc: For CAN logs: what the frames mean.
            signals: A map of names and units, or a dict.
            where: Which rows of a table, ``"car=A"``.
            progress: As in :func:`itpms.estimate`.

        Raises:
            LogError: a drive cannot be used.
            SettingError: a pressure is missing or no tire's, or a drive taught nothing.
        """
        inner = learn(self._inner, drives, pressure_kpa, trust_units, dbc, signals, where, progress)
        return Learned(inner, Vehicle(inner.vehicle))

    def check(
        self,
        drive: Any,
        *,
        trust_units: bool = False,
        dbc: str | PathLike[str] | None = None,
        signals: Signals = None,
        where: Where = None,
        progress: bool | None = None,
    ) -> Checked:
        """Holds the car's suspension against a drive, as ``itpms vehicle check`` does.

        Compares how the body above each wheel answers it with what mass, spring and damper of the file say; road, tire and unsprung mass
        do not enter. The interpreter's lock is free meanwhile; Ctrl-C ends it.

        Args:
            drive: A path or a table as for :func:`itpms.estimate`.
            trust_units: As in :func:`itpms.estimate`, like the following.
            dbc: For CAN logs: what the frames mean.
            signals: A map of names and units, or a dict.
            where: Which rows of a table, ``"car=A"``.
            progress: As in :func:`itpms.estimate`.

        Raises:
            LogError: the drive cannot be used.
            SettingError: an argument is refused, or the drive has none of the car's corners.
        """
        return check(self._inner, drive, trust_units, dbc, signals, where, progress)

    def to_toml(self) -> str:
        """The text of a vehicle file that reads back as this car."""
        return self._inner.to_toml()

    def write(self, path: str | PathLike[str]) -> None:
        """Writes a vehicle file, completely or not at all.

        Raises:
            OutputError: the file cannot be written.
        """
        self._inner.write(path)

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return Vehicle.parse, (self.to_toml(),)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Vehicle) and self.to_toml() == other.to_toml()

    def __hash__(self) -> int:
        return hash(self.to_toml())

    def __repr__(self) -> str:
        return f"<itpms.Vehicle {self.name!r}, corners {' '.join(self.corners)}>"


class Learned:
    """What drives have told of a car. Made by :meth:`itpms.Vehicle.learn`.

    Attributes:
        vehicle: The car with the learned parameters in place of the file's: the one to go on with.
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


def vehicle_of(given: Vehicle | str | PathLike[str]) -> Vehicle:
    """The car that was given, or that of a file."""
    return given if isinstance(given, Vehicle) else Vehicle.read(given)
