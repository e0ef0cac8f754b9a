"""Drives of a fleet on Apache Spark: a data frame of samples in, a data frame with a row per drive and wheel out.

Needs PySpark 4 with its pandas and pyarrow (``pip install pyspark pandas pyarrow``), and Java where Spark runs; ``itpms`` itself has to be installed
on every worker.

>>> import itpms.spark
>>> samples = spark.read.parquet("logs")  # doctest: +SKIP
>>> wheels = itpms.spark.estimate(samples, "cars")  # doctest: +SKIP
>>> wheels.where("warning = 'low'").show()  # doctest: +SKIP
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import chain, groupby
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _itpms
from ._errors import ItpmsError, LogError, SettingError
from ._pieces import MEANT, Pieces
from ._tables import columns_of
from ._vehicle import Vehicle, vehicle_of

if TYPE_CHECKING:
    from pyspark.sql import DataFrame

# A row of the result after the columns that say which car and which drive: name and Spark type. Those of fleet.csv.
COLUMNS: tuple[tuple[str, str], ...] = (
    ("vehicle", "string"),
    ("wheel", "string"),
    ("placard_kpa", "double"),
    ("pressure_kpa", "double"),
    ("pressure_sd_kpa", "double"),
    ("pressure_time_s", "double"),
    ("lowest_kpa", "double"),
    ("lowest_sd_kpa", "double"),
    ("lowest_time_s", "double"),
    ("state", "string"),
    ("warning", "string"),
    ("warnings", "int"),
    ("first_warning_s", "double"),
    ("malfunctions", "int"),
    ("first_malfunction_s", "double"),
    ("share_valid", "double"),
    ("iri_m_per_km", "double"),
    ("incoherence", "double"),
    ("unexplained", "double"),
    ("hop_excess", "double"),
    ("friction_n", "double"),
    ("misfit", "string"),
    ("distance_m", "double"),
    ("duration_s", "double"),
    ("rate_hz", "double"),
    ("start_s", "double"),
    ("calibration", "string"),
    ("concerns", "string"),
    ("lost_share", "double"),
    ("lost_share_sd", "double"),
    ("detectable_loss", "double"),
    ("damper", "string"),
    ("damper_over_reference", "double"),
    ("damper_left_right", "double"),
    ("error", "string"),
)
# Only what is known at the end is wanted: hardly a row of the estimates over time is kept.
_RATE_HZ = 1e-3
# How the extension begins when it broke down.
_FAULT = "a fault of this program"


def estimate(
    df: DataFrame,
    vehicles: Mapping[str, Vehicle | str | PathLike[str]] | Vehicle | str | PathLike[str],
    *,
    car: str | None = "car",
    drive: str | Sequence[str] = "drive",
    time: str = "time_s",
    references: Mapping[str, str | PathLike[str]] | None = None,
    calibrate_s: float | None = None,
    calibration: str | None = None,
    estimator: str = "informed",
    regulation: str = "un-r141",
    road_repeats: float | str = "auto",
    trust_units: bool = False,
    signals: str | PathLike[str] | None = None,
    partitions: int | None = None,
) -> DataFrame:
    """Estimates every drive of a fleet: the rows of ``itpms fleet``, to the last digit.

    The samples are shuffled by car and drive and sorted by time; each drive is then estimated batch by batch, so that a worker's
    memory does not grow with the length of a drive. Nothing is computed before Spark is asked for a result. With ``calibrate_s`` what
    a calibration drive teaches is carried to the car's later drives: then all drives of a car are one task's, in the order of
    ``drive``.

    Args:
        df: A sample per row. Columns: those of :func:`itpms.estimate` (``{c}_body_accel_m_s2``, ``{c}_wheel_accel_m_s2``
            in m/s², ``speed_m_s`` in m/s; null or NaN where a sample is missing), the time, and which car and drive it is of.
        vehicles: By the car's name its :class:`itpms.Vehicle` or the path of its file; or a folder in which each ``CAR.toml`` is
            a car and ``CAR.reference`` what a calibration drive taught of it; or one vehicle for all. Read here, not on the
            workers.
        car: The column with the car's name; None where there is one vehicle and no such column.
        drive: The column, or columns, that tell the drives of a car apart.
        time: The column with the time: s as a number, or a timestamp. With ``signals`` the rows are sorted by it, and the map says
            what it is.
        references: By the car's name, the path of the reference that an earlier calibration drive stored.
        calibrate_s: The first so many seconds of a calibration drive are driven at placard pressure.
        calibration: The column that says, true or false, whether it is a calibration drive; each car's first drive unless given.
        estimator: As in :func:`itpms.estimate`, like the following.
        regulation: Which loss is warned of.
        road_repeats: Whether the road repeats itself: seconds, ``never`` or ``auto``.
        trust_units: Do not doubt the units.
        signals: A map of the columns' names and units, as ``itpms signals`` writes it.
        partitions: Into how many tasks the drives are dealt; ``spark.sql.shuffle.partitions`` unless given. A drive is estimated by
            one task, so fewer drives than cores leave some idle.

    Returns:
        A row per drive and wheel, in no certain order: the columns ``car`` and ``drive`` as they are in ``df``, then
        :data:`COLUMNS`, with the meaning and the units of ``fleet.csv``. A drive that cannot be estimated has one row with
        nothing but its ``error``, the sentence that ``itpms estimate`` would end with; it does not end the job.

    Raises:
        SettingError: PySpark, pandas or pyarrow is not installed, an argument is refused, or a column is not there.
        VehicleError: a vehicle file cannot be used.
    """
    functions = _pyspark()
    keys = ([] if car is None else [car]) + ([drive] if isinstance(drive, str) else list(drive))
    _check_columns(df.columns, keys, time)
    if calibration is not None:
        if calibration not in df.columns:
            raise SettingError(
                f"column {calibration} is not in the data frame, expected one of: {', '.join(df.columns)}"
            )
        if calibrate_s is None:
            raise SettingError("calibration is given without calibrate_s: how long is it at placard pressure?")
    if partitions is not None and not partitions >= 1:
        raise SettingError(f"partitions is {partitions}, expected 1 or more")
    options = {
        "rate_hz": _RATE_HZ,
        "pressure_unit": "kpa",
        "road": False,
        "road_map": False,
        "report": False,
        "roughness": True,
        "estimator": estimator,
        "regulation": regulation,
        "calibrate_s": calibrate_s,
        "save_reference": None,
        "reference": None,
        "road_repeats": road_repeats,
        "trust_units": trust_units,
        "dbc": None,
        "signals": None,
        "rows": [],
        "pulses": None,
    }
    job = _Job(keys, car is not None, calibration, options, None if signals is None else _content(signals))
    job.take_cars(vehicles, references or {})
    job.check()

    # A column that means nothing is only looked at for its name, which may be a misspelled one.
    ours = {*keys, *([] if calibration is None else [calibration])}
    job.others = [] if signals is not None else [name for name in df.columns if name not in {*ours, time, *MEANT}]
    wanted = [name for name in df.columns if name in {*ours, *MEANT} or signals is not None]
    clock = "time_s" if signals is None else time
    samples = [functions.col(f"`{name}`") for name in wanted if name not in (time, clock)]
    chosen = df.select(*samples, functions.col(f"`{time}`").alias(clock))
    parts = partitions or int(df.sparkSession.conf.get("spark.sql.shuffle.partitions") or 200)
    columns = [f"`{name}`" for name in keys]
    if calibrate_s is None:
        dealt = chosen.repartition(parts, *columns)
    else:
        # A car's drives follow each other.
        dealt = chosen.repartition(1) if car is None else chosen.repartition(parts, columns[0])
    sorted_drives = dealt.sortWithinPartitions(*columns, f"`{clock}`")
    types = [f"`{name}` {df.schema[name].dataType.simpleString()}" for name in keys]
    schema = ", ".join(types + [f"{name} {kind}" for name, kind in COLUMNS])
    return sorted_drives.mapInArrow(job.run, schema)


def _pyspark() -> Any:
    try:
        # PySpark itself asks for pandas and pyarrow, later and in other words.
        import pandas  # noqa: F401
        import pyarrow  # noqa: F401
        from pyspark.sql import functions
    except ImportError as error:
        raise SettingError(f"{error.name} is not installed, expected pip install pyspark pandas pyarrow") from None
    return functions


def _check_columns(names: Sequence[str], keys: Sequence[str], time: str) -> None:
    for name in (*keys, time):
        if name not in names:
            raise SettingError(f"column {name} is not in the data frame, expected one of: {', '.join(names)}")
    if len({*keys, time}) != len(keys) + 1 or len(keys) == 0:
        raise SettingError(f"car, drive and time are the columns {', '.join((*keys, time))}, expected different ones")
    taken = {"time_s", *(name for name, _ in COLUMNS)}
    for name in keys:
        if name in taken:
            raise SettingError(f"column {name} is one of the result, too; expected another name for car or drive")


def _content(path: str | PathLike[str]) -> bytes:
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise SettingError(f"{path}: cannot be read: {error.strerror}") from None


@dataclass
class _Job:
    """What goes to the workers: plain data only."""

    keys: list[str]
    has_car: bool
    calibration: str | None
    options: dict[str, Any]
    signals: bytes | None
    # Vehicle files and stored references by the car's name; under None those of all.
    cars: dict[str | None, str] = field(default_factory=dict)
    references: dict[str | None, bytes] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)

    def take_cars(
        self,
        vehicles: Mapping[str, Vehicle | str | PathLike[str]] | Vehicle | str | PathLike[str],
        references: Mapping[str, str | PathLike[str]],
    ) -> None:
        stored = dict(references)
        if not isinstance(vehicles, (Mapping, Vehicle)) and Path(vehicles).is_dir():
            files = sorted(Path(vehicles).glob("*.toml"))
            beside = {file.stem: file.with_suffix(".reference") for file in files}
            stored = {name: path for name, path in beside.items() if path.exists()} | stored
            vehicles = {file.stem: file for file in files}
        if isinstance(vehicles, Mapping):
            if not vehicles:
                raise SettingError("vehicles holds no car, expected a vehicle file for each")
            if not self.has_car:
                raise SettingError("vehicles are several and car is None, expected the column with the car's name")
            self.cars = {str(name): vehicle_of(vehicle).to_toml() for name, vehicle in vehicles.items()}
            stranger = next((name for name in stored if name not in self.cars), None)
            if stranger is not None:
                raise SettingError(f"references has {stranger!r}, expected one of the cars of vehicles")
        else:
            self.cars = {None: vehicle_of(vehicles).to_toml()}
            if stored and not self.has_car:
                raise SettingError("references are given by the car's name and car is None, expected its column")
        self.references = {name: _content(path) for name, path in stored.items()}

    def check(self) -> None:
        """Refuses here what every task would refuse."""
        text = next(iter(self.cars.values()))
        _itpms.Car(_itpms.Vehicle.parse(text), 500.0, list(Vehicle.parse(text).corners), self.options)

    def run(self, batches: Iterator[Any]) -> Iterator[Any]:
        """Rows of a partition, sorted by drive and time, become rows of wheels."""
        with tempfile.TemporaryDirectory(prefix="itpms-") as folder:
            options = self.options if self.signals is None else self.options | {"signals": f"{folder}/map.toml"}
            if self.signals is not None:
                Path(options["signals"]).write_bytes(self.signals)
            history = _History()
            for _, numbered in groupby(self._pieces(batches), key=lambda piece: piece[0]):
                pieces = (piece for _, piece in numbered)
                yield self._drive(next(pieces), pieces, options, folder, history)

    def _pieces(self, batches: Iterator[Any]) -> Iterator[tuple[int, Any]]:
        """Each batch cut where a drive ends; with the drive's number in this partition."""
        number, last = 0, None
        for batch in batches:
            start = 0
            for end in (*self._ends(batch), batch.num_rows):
                if end == start:
                    continue
                piece = batch.slice(start, end - start)
                key = [piece.column(name)[0].as_py() for name in self.keys]
                if last is not None and key != last:
                    number += 1
                last, start = key, end
                yield number, piece

    def _ends(self, batch: Any) -> list[int]:
        """Rows at which another drive begins."""
        import numpy as np
        import pyarrow.compute as pc

        rows = batch.num_rows
        changed = np.zeros(max(rows - 1, 0), dtype=bool)
        for name in self.keys:
            values = batch.column(name)
            before, after = values.slice(0, max(rows - 1, 0)), values.slice(1)
            other = pc.not_equal(before, after).fill_null(False)
            unknown = pc.xor(before.is_null(), after.is_null())
            changed |= pc.or_(other, unknown).to_numpy(zero_copy_only=False)
        found: list[int] = (np.flatnonzero(changed) + 1).tolist()
        return found

    def _drive(self, first: Any, rest: Iterator[Any], options: dict[str, Any], folder: str, history: _History) -> Any:
        """The rows of a drive that comes in pieces."""
        import pyarrow as pa

        key = [first.column(name)[0].as_py() for name in self.keys]
        try:
            rows = self._wheels(key, first, rest, options, folder, history)
        except ItpmsError as error:
            rows = [{"error": str(error)}]
        except RuntimeError as error:
            # A fault in one drive is that drive's failure and not the fleet's.
            if _FAULT not in str(error):
                raise
            rows = [{"error": f"{'/'.join(map(str, key))}: {error}"}]
        same = {
            name: pa.array([value] * len(rows), first.schema.field(name).type)
            for name, value in zip(self.keys, key, strict=True)
        }
        kinds = {"string": pa.string(), "double": pa.float64(), "int": pa.int32()}
        found = {name: pa.array([row.get(name) for row in rows], kinds[kind]) for name, kind in COLUMNS}
        return pa.RecordBatch.from_pydict(same | found)

    def _wheels(
        self,
        key: list[Any],
        first: Any,
        rest: Iterator[Any],
        options: dict[str, Any],
        folder: str,
        history: _History,
    ) -> list[dict[str, Any]]:
        name = "/".join(map(str, key))
        missing = next((column for column, value in zip(self.keys, key, strict=True) if value is None), None)
        if missing is not None:
            raise LogError(f"{name}: rows without a {missing}, expected one in every row")
        id = str(key[0]) if self.has_car else None
        text = self.cars.get(id, self.cars.get(None))
        if text is None:
            raise LogError(f"{name}: no car's, expected {id!r} to be one of the {len(self.cars)} vehicles")
        seconds = options["calibrate_s"]
        if seconds is not None:
            told = None if self.calibration is None else bool(first.column(self.calibration)[0].as_py())
            seconds = seconds if history.begins(id, told) else None
        reference = None if seconds is not None else history.taught or self.references.get(id)
        stored = f"{folder}/car.reference"
        if reference is not None:
            Path(stored).write_bytes(reference)
        options = options | {"calibrate_s": seconds, "reference": None if reference is None else stored}
        vehicle = _vehicle(text)
        tables = (self._table(piece) for piece in chain([first], rest))
        pieces = Pieces(name, tables, mapped=options["signals"] is not None)
        done = _itpms.estimate_pieces(name, pieces.names, None, iter(pieces), vehicle._inner, options, None)
        drive = json.loads(done.figures())
        concerns, taught = drive["warnings"], False
        if seconds is not None:
            why = done.teach(stored)
            taught = why is None
            history.taught = Path(stored).read_bytes() if taught else history.taught
            concerns = concerns if why is None else [*concerns, why]
        same = {
            "vehicle": vehicle.name,
            "distance_m": drive["distance_m"],
            "duration_s": drive["duration_s"],
            "rate_hz": drive["rate_hz"],
            "start_s": done.start_s(),
            "calibration": "drive" if taught else "none" if reference is None else "carried",
            "concerns": "; ".join(concerns),
        }
        return [same | _flat(wheel) for wheel in json.loads(done.wheels())]

    def _table(self, piece: Any) -> dict[str, Any]:
        import numpy as np

        columns = columns_of(piece)
        for name in self.keys if self.calibration is None else [*self.keys, self.calibration]:
            del columns[name]
        nothing = np.full(piece.num_rows, np.nan)
        return columns | dict.fromkeys(self.others, nothing)


@dataclass
class _History:
    """The drives of a car that came before, in the order of a partition."""

    car: str | None = None
    begun: bool = False
    taught: bytes | None = None

    def begins(self, car: str | None, told: bool | None) -> bool:
        """A drive of this car begins; whether it is a calibration drive, which is told, or else is each car's first."""
        if not self.begun or car != self.car:
            self.car, self.begun, self.taught = car, True, None
            return True if told is None else told
        return bool(told)


@lru_cache(maxsize=64)
def _vehicle(text: str) -> Vehicle:
    return Vehicle.parse(text)


def _flat(wheel: dict[str, Any]) -> dict[str, Any]:
    """A wheel's record by the names of the columns."""
    last, lowest, fit, lost, damper = (
        wheel.pop(name, None) or {} for name in ("last", "lowest", "fit", "lost", "damper")
    )
    return {
        **wheel,
        "pressure_kpa": last.get("pressure_kpa"),
        "pressure_sd_kpa": last.get("sd_kpa"),
        "pressure_time_s": last.get("time_s"),
        "lowest_kpa": lowest.get("pressure_kpa"),
        "lowest_sd_kpa": lowest.get("sd_kpa"),
        "lowest_time_s": lowest.get("time_s"),
        "lost_share": lost.get("share"),
        "lost_share_sd": lost.get("sd"),
        "detectable_loss": lost.get("detectable"),
        "damper": damper.get("state"),
        "damper_over_reference": damper.get("over_reference"),
        "damper_left_right": damper.get("left_right"),
        **fit,
    }
