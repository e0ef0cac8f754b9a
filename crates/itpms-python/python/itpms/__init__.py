"""Indirect tire pressure monitoring: tire pressure and road from the accelerations of a car's body and wheels.

>>> import itpms
>>> drive = itpms.simulate("drive-puncture", seed=1)
>>> result = itpms.estimate(drive)
>>> round(result.summary["corners"]["fl"]["last"]["pressure_kpa"])
138
"""

from . import vehicle
from ._check import Checked
from ._errors import ItpmsError, LogError, OutputError, ScenarioError, SettingError, VehicleError
from ._estimate import Car, Simulation, estimate, iri, scenarios, simulate
from ._itpms import __version__
from ._result import Result
from ._vehicle import Learned, Vehicle

__all__ = [
    "Car",
    "Checked",
    "ItpmsError",
    "Learned",
    "LogError",
    "OutputError",
    "Result",
    "ScenarioError",
    "SettingError",
    "Simulation",
    "Vehicle",
    "VehicleError",
    "__version__",
    "estimate",
    "iri",
    "scenarios",
    "simulate",
    "vehicle",
]
