"""A car's parameters, by the names of the commands: ``itpms vehicle init``, ``learn`` and ``check``.

>>> import itpms
>>> car = itpms.vehicle.init(1500, 0.55, "205/55R16")
>>> car.name
'sedan, 1500 kg, 205/55R16'
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from typing import Any

from ._check import Checked
from ._learn import Pressures
from ._vehicle import Learned, Vehicle, vehicle_of

__all__ = ["check", "init", "learn"]

init = Vehicle.typical


def learn(
    drives: Any,
    pressure_kpa: Pressures | Sequence[Pressures],
    vehicle: Vehicle | str | PathLike[str],
    **options: Any,
) -> Learned:
    """What drives at known pressures tell of a car: :meth:`itpms.Vehicle.learn`, whose ``options`` it takes.

    Args:
        drives: A drive or a list of them, each a path or a table.
        pressure_kpa: What the tires had while driving, kPa gauge.
        vehicle: The car to begin with, or the path of its file.
        options: As of :meth:`itpms.Vehicle.learn`.
    """
    return vehicle_of(vehicle).learn(drives, pressure_kpa, **options)


def check(drive: Any, vehicle: Vehicle | str | PathLike[str], **options: Any) -> Checked:
    """Holds a vehicle file against a drive: :meth:`itpms.Vehicle.check`, whose ``options`` it takes.

    Args:
        drive: A path or a table as for :func:`itpms.estimate`.
        vehicle: The car, or the path of its file.
        options: As of :meth:`itpms.Vehicle.check`.
    """
    return vehicle_of(vehicle).check(drive, **options)
