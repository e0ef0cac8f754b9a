"""A whole drive, a running car, a made-up drive, a road: the package's functions."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
import numpy.typing as npt

from . import _itpms
from ._errors import LogError, SettingError
from ._itpms import write
from ._pieces import MEANT, TABLE, taken
from ._progress import progress_bar
from ._result import Result
from ._signals import Signals, Where, map_file, rows_where
from ._tables import Columns, Kind, collected, columns_of, kind_of, numbers, table_of, unpacked, usual
from ._vehicle import Vehicle, vehicle_of

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


def estimate(
    drive: Any,
    vehicle: Vehicle | str | PathLike[str] | None = None,
    *,
    rate_hz: float = 10.0,
    road: bool = False,
    road_map: bool = False,
    report: bool = True,
    estimator: str = "informed",
    regulation: str = "un-r141",
    calibrate_s: float | None = None,
    save_reference: str | PathLike[str] | None = None,
    reference: str | PathLike[str] | None = None,
    road_repeats: float | str = "auto",
    trust_units: bool = False,
    dbc: str | PathLike[str] | None = None,
    signals: Signals = None,
    where: Where = None,
    pulses: str | PathLike[str] | None = None,
    pressure_unit: str = "kpa",
    progress: bool | None = None,
) -> Result:
    """Estimates tire pressures, their standard deviations and the road from a drive.

    Gives the same numbers as ``itpms estimate``. The interpreter's lock is free meanwhile; Ctrl-C ends it.

    Args:
        drive: A path in any format that the program reads (CSV, Parquet, MDF4, CAN logs), a pandas or polars data frame,
            a pyarrow table, a dict of arrays of shape (rows,), an iterator over such tables (pieces of a drive in the order of
            time, one at a time in memory), or what :func:`simulate` gives. Columns: ``time_s`` (s, or
            datetimes or timedeltas; in pandas the index will do), ``{c}_body_accel_m_s2`` and ``{c}_wheel_accel_m_s2``
            (m/s², up) for each corner ``c`` of ``fl fr rl rr`` that was measured, and, worth having, ``speed_m_s``. A missing
            sample is NaN, None or NA. ``{c}_pressure_kpa`` and ``{c}_road_m`` are taken for the truth, to be compared with.
        vehicle: The car: a :class:`Vehicle` or the path of a vehicle file. A simulated drive has its own.
        rate_hz: Rows per second of the result.
        road: Keep the road under each wheel, at the log's rate.
        road_map: Keep :attr:`Result.road_map`, which has the places where the car was: the drive needs ``latitude_deg`` and
            ``longitude_deg``.
        report: Keep what :meth:`Result.report` shows, and tell the roughness of the road. Without it the road is not smoothed, which
            is a quarter of the work.
        estimator: ``informed``, ``aekf-ui-informed``, or as published ``aekf-ui``, ``ekf-ui``.
        regulation: ``un-r141`` or ``fmvss-138``: which loss is warned of.
        calibrate_s: The first so many seconds are driven at placard pressure.
        save_reference: Where what that teaches of the car goes; with ``reference``, where that goes with what this day has shown of the
            wheel speeds (it may be the same file).
        reference: What an earlier calibration drive taught of this car.
        road_repeats: Whether the road repeats itself, as on a test bed: seconds, ``never`` or ``auto``.
        trust_units: Take accelerations as m/s² and the speed as m/s even if they do not look like it.
        dbc: For a CAN log: what the frames mean.
        signals: Which signal, or column of a table, is which of our columns, and its unit: a map as ``itpms signals`` writes it, or
            a dict such as ``{"speed_m_s": "v", "fl_body_accel_m_s2": {"signal": "a", "unit": "g"}}``.
        where: Of a table only the rows that have this value in a column, or in a key of a folder's parts: ``"car=A"`` or
            ``{"car": "A"}``.
        pulses: The tooth pulses of the four wheels, by the drive's clock: a CSV or Parquet file with ``time_s`` and ``wheel``. They
            count together with the drive's wheel speeds, and show a loss of all four alike.
        pressure_unit: ``kpa``, ``bar`` or ``psi``: the unit of the report and of the sentences. Numbers are in kPa.
        progress: Show how far it is with tqdm (``pip install tqdm``); unless given, in a notebook that has tqdm.

    Raises:
        LogError: the drive cannot be used.
        VehicleError: the vehicle file cannot be used.
        SettingError: an argument is refused, or some do not go together.
        OutputError: the reference cannot be written.
    """
    options: dict[str, Any] = {
        "rate_hz": rate_hz,
        "road": road,
        "road_map": road_map,
        "report": report,
        "roughness": False,
        "estimator": estimator,
        "regulation": regulation,
        "calibrate_s": calibrate_s,
        "save_reference": save_reference,
        "reference": reference,
        "road_repeats": road_repeats,
        "trust_units": trust_units,
        "dbc": dbc,
        "rows": rows_where(where),
        "pulses": pulses,
        "pressure_unit": pressure_unit,
    }
    if isinstance(drive, Simulation):
        vehicle = drive.vehicle if vehicle is None else vehicle
    if vehicle is None:
        raise SettingError("vehicle is missing, expected a Vehicle or the path of a vehicle file")
    car = vehicle_of(vehicle)._inner
    with progress_bar(progress, "estimating") as told, map_file(signals) as options["signals"]:
        if isinstance(drive, (str, PathLike)):
            return Result(_itpms.estimate_log(drive, car, options, told), usual(), None)
        if dbc is not None:
            raise SettingError("dbc says what the frames of a CAN log mean; this drive is a table")
        kind, table = (
            (drive.kind, drive.columns) if isinstance(drive, Simulation) else (kind_of(drive), collected(drive))
        )
        pieces, rows = taken(TABLE, table, mapped=signals is not None)
        inner = _itpms.estimate_pieces(TABLE, pieces.names, rows, iter(pieces), car, options, told)
    return Result(inner, kind or usual(), None if isinstance(drive, Iterator) else table)


class Simulation:
    """A made-up drive with its truth. Made by :func:`simulate`; :func:`estimate` takes it as it is."""

    def __init__(self, inner: _itpms.Simulated, kind: Kind) -> None:
        self.name: str = inner.name
        self.vehicle: Vehicle = Vehicle(inner.vehicle)
        self.kind: Kind = kind
        self.columns: Columns = unpacked(inner.columns())

    @overload
    def frame(self, kind: Literal["pandas"]) -> pandas.DataFrame: ...
    @overload
    def frame(self, kind: Literal["polars"]) -> polars.DataFrame: ...
    @overload
    def frame(self, kind: Literal["pyarrow"]) -> pyarrow.Table: ...
    @overload
    def frame(self, kind: Literal["numpy", "dict"]) -> Columns: ...
    @overload
    def frame(self, kind: None = None) -> Any: ...
    def frame(self, kind: Kind | None = None) -> Any:
        """The drive log as a table: ``time_s``, ``speed_m_s`` and per corner accelerations, pressure and road."""
        return table_of(self.columns, kind or self.kind)

    def __repr__(self) -> str:
        time_s = self.columns["time_s"]
        return f"<itpms.Simulation {self.name}, {len(time_s)} rows, {time_s[-1] - time_s[0]:.1f} s>"


def simulate(
    scenario: str | PathLike[str],
    seed: int = 1,
    *,
    vehicle: Vehicle | str | PathLike[str] | None = None,
    truth: bool = True,
    progress: bool | None = None,
) -> Simulation:
    """Drives a scenario. The same seed gives the same drive, that of ``itpms lab simulate``.

    Args:
        scenario: A built-in name (:func:`scenarios`) or the path of a scenario file (TOML).
        seed: Of road, noise and losses; 0 or more.
        vehicle: Drive this car instead of the scenario's own.
        truth: Put the true pressure and road beside the measurements.
        progress: As in :func:`estimate`.

    Raises:
        ScenarioError: there is no such scenario, or it cannot be driven.
    """
    if not 0 <= seed < 2**64:
        raise SettingError(f"seed is {seed}, expected 0 to 2**64 - 1")
    car = None if vehicle is None else vehicle_of(vehicle)._inner
    with progress_bar(progress, "driving") as told:
        return Simulation(_itpms.simulate(os.fspath(scenario), seed, car, truth, told), usual())


def scenarios() -> list[str]:
    """The names of the built-in scenarios."""
    return _itpms.scenarios()


@overload
def iri(profile: npt.ArrayLike, dx: float, *, segment_m: None = None, enveloped: bool = False) -> float: ...
@overload
def iri(profile: npt.ArrayLike, dx: float, *, segment_m: float, enveloped: bool = False) -> npt.NDArray[np.float64]: ...
def iri(
    profile: npt.ArrayLike, dx: float, *, segment_m: float | None = None, enveloped: bool = False
) -> float | npt.NDArray[np.float64]:
    """International Roughness Index (ASTM E1926) of a road profile, in m/km.

    Args:
        profile: Heights in m, of shape (points,), evenly spaced.
        dx: Their spacing in m, more than 0 and at most 1.
        segment_m: Give the IRI of each whole segment of this length, of shape (segments,), instead of one for all.
        enveloped: The profile was seen through a tire already: no moving average over 250 mm.

    Returns:
        The IRI; NaN where a height is missing or the profile is too short.

    Raises:
        SettingError: the spacing is no spacing.
    """
    heights = numbers("profile", np.asanyarray(profile))
    if segment_m is not None and not segment_m >= dx:
        raise SettingError(f"segment_m is {segment_m}, expected at least the spacing of {dx} m")
    found = np.frombuffer(_itpms.iri(heights.tobytes(), dx, segment_m, not enveloped), dtype="<f8")
    return float(found[0]) if segment_m is None else found.copy()


class Car:
    """A running estimator under its monitor: takes samples as they come, can be saved and go on.

    Two threads may have it: one waits for the other. It can be pickled, as :meth:`save` saves it.
    """

    def __init__(
        self,
        vehicle: Vehicle | str | PathLike[str],
        rate_hz: float,
        *,
        corners: tuple[str, ...] | None = None,
        estimator: str = "informed",
        regulation: str = "un-r141",
        calibrate_s: float | None = None,
        reference: str | PathLike[str] | None = None,
        road_repeats: float | str = "auto",
    ) -> None:
        """An estimator that has seen nothing yet.

        Args:
            vehicle: The car, or the path of its file.
            rate_hz: Samples per second, 100 Hz to 2 kHz.
            corners: Those that are measured; all of the vehicle unless given.
            estimator: As in :func:`estimate`.
            regulation: As in :func:`estimate`.
            calibrate_s: The first so many seconds are driven at placard pressure.
            reference: What an earlier calibration drive taught of this car.
            road_repeats: As in :func:`estimate`.

        Raises:
            VehicleError: the vehicle file cannot be used.
            SettingError: an argument is refused.
        """
        car = vehicle_of(vehicle)
        options = {
            "rate_hz": 10.0,
            "pressure_unit": "kpa",
            "road": False,
            "road_map": False,
            "report": False,
            "roughness": False,
            "estimator": estimator,
            "regulation": regulation,
            "calibrate_s": calibrate_s,
            "save_reference": None,
            "reference": reference,
            "road_repeats": road_repeats,
            "trust_units": False,
            "dbc": None,
            "signals": None,
            "rows": [],
            "pulses": None,
        }
        self._take(_itpms.Car(car._inner, rate_hz, list(corners or car.corners), options))

    def _take(self, inner: _itpms.Car) -> None:
        """What does not change is asked for once: no thread waits for it."""
        self._inner, self._lock = inner, Lock()
        self._corners, self._rate_hz, self._vehicle = inner.corners(), inner.rate_hz, Vehicle(inner.vehicle)

    def update(self, samples: Mapping[str, float] | Any) -> dict[str, Any]:
        """Takes one sample or many, in the order of time.

        Args:
            samples: A dict of numbers, or a table or dict of arrays of shape (rows,), with the columns of :func:`estimate`.
                ``time_s`` and the accelerations of all corners have to be there; what is missing is NaN.

        Returns:
            By the names of :meth:`Result.frame`: the estimate after the sample as numbers, or after every sample as arrays.

        Raises:
            SettingError: a column is missing, or they are not of one length.
            KeyboardInterrupt: Ctrl-C; samples up to some point were taken.
        """
        single = isinstance(samples, Mapping) and np.isscalar(samples.get("time_s", 0.0))
        columns = {n: np.atleast_1d(v) for n, v in samples.items()} if single else columns_of(samples)
        given = [(name, numbers(name, values).tobytes()) for name, values in columns.items() if name in MEANT]
        with self._lock:
            estimates = self._inner.update(given)
        found = unpacked(*estimates)
        return (
            {name: values[0].item() if hasattr(values[0], "item") else values[0] for name, values in found.items()}
            if single
            else found
        )

    @property
    def states(self) -> dict[str, str]:
        """Each wheel's state after the last sample: ``unknown``, ``uncertain``, ``fine``, ``low``, ``over`` or ``malfunction``."""
        found: dict[str, str] = json.loads(self._status())["states"]
        return found

    @property
    def alerts(self) -> list[dict[str, Any]]:
        """The alerts that stand after the last sample."""
        found: list[dict[str, Any]] = json.loads(self._status())["alerts"]
        return found

    def _status(self) -> str:
        with self._lock:
            return self._inner.status()

    @property
    def corners(self) -> list[str]:
        """Labels of the corners that are estimated."""
        return list(self._corners)

    @property
    def rate_hz(self) -> float:
        """Samples per second."""
        return self._rate_hz

    @property
    def vehicle(self) -> Vehicle:
        """The car's parameters."""
        return self._vehicle

    def save_reference(self, path: str | PathLike[str]) -> None:
        """Stores what the calibration drive taught of the car.

        Raises:
            SettingError: nothing was learned.
            OutputError: the file cannot be written.
        """
        with self._lock:
            self._inner.save_reference(path)

    def save(self, path: str | PathLike[str]) -> None:
        """Saves the running estimator; :meth:`load` goes on from there to the same numbers, with the same version.

        Raises:
            OutputError: the file cannot be written.
        """
        write(path, self._state())

    def _state(self) -> bytes:
        with self._lock:
            return self._inner.state()

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Car:
        """The estimator that was saved.

        Raises:
            LogError: the file cannot be read.
            SettingError: it is no saved car, of another version, or damaged.
        """
        try:
            state = Path(path).read_bytes()
        except OSError as error:
            raise LogError(f"{path}: cannot be read: {error.strerror}") from None
        return cls._of_state(str(path), state)

    @classmethod
    def _of_state(cls, name: str, state: bytes) -> Car:
        car = cls.__new__(cls)
        car._take(_itpms.Car.of_state(name, state))
        return car

    def __reduce__(self) -> tuple[Any, tuple[str, bytes]]:
        return Car._of_state, ("the pickled car", self._state())

    def __repr__(self) -> str:
        return f"<itpms.Car {self.vehicle.name!r}, corners {' '.join(self.corners)}, {self.rate_hz:g} Hz>"
