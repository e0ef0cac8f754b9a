"""Indirect tire pressure monitoring: tire pressure and road from the accelerations of a car's body and wheels.

>>> import itpms
>>> drive = itpms.simulate("drive-puncture", seed=1)
>>> result = itpms.estimate(drive)
>>> round(result.summary["corners"]["fl"]["last"]["pressure_kpa"])
138
"""

from ._errors import ItpmsError, LogError, OutputError, ScenarioError, SettingError, VehicleError
from ._estimate import Car, Simulation, estimate, iri, scenarios, simulate
from ._itpms import __version__
from ._learn import Learned
from ._result import Result
from ._vehicle import Vehicle

__all__ = [
    "Car",
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
]
