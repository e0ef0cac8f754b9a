"""What was found in a drive."""

from __future__ import annotations

import json
from html import escape
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, overload

from . import _itpms
from ._errors import SettingError
from ._itpms import write
from ._kept import Kept
from ._tables import Columns, Kind, columns_of, table_of, unpacked

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow
    from matplotlib.figure import Figure


class Result:
    """What was found in a drive. Made by :func:`itpms.estimate`.

    Attributes:
        corners: Labels of the corners that were estimated, of ``fl fr rl rr``.
        summary: What ``itpms estimate --json`` prints: duration, distance, per corner the last and the lowest pressure,
            warnings and roughness.
    """

    def __init__(self, inner: _itpms.Estimated | Kept, kind: Kind, source: Any) -> None:
        self._inner = inner
        self._kind = kind
        self._source = source
        self._columns: Columns | None = None
        self.corners: list[str] = inner.corners()
        self.summary: dict[str, Any] = json.loads(inner.figures())

    @property
    def columns(self) -> Columns:
        """The estimates as arrays of shape (rows,), by the columns' names: see :meth:`frame`."""
        if self._columns is None:
            self._columns = unpacked(self._inner.estimates(), self._inner.warnings())
        return dict(self._columns)

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
        """The estimates as a table of the library that the drive came in, or of another.

        Columns: ``time_s``, then per corner ``{c}_pressure_kpa``, ``{c}_pressure_sd_kpa`` (kPa),
        ``{c}_stiffness_n_per_m`` (N/m), ``{c}_valid`` (bool), ``{c}_warning`` (``none``, ``low`` or ``malfunction``),
        ``{c}_change_sd_kpa`` (kPa; of what has changed of late, while ``{c}_pressure_sd_kpa`` has what the vehicle file leaves
        open, too), ``{c}_level`` (what the pressure's level rests on: ``file``, ``calibration`` or
        ``reference``),
        ``{c}_axle_difference_sd_kpa`` (kPa; of what it differs by from the axle's other tire),
        ``{c}_lost_kpa``, ``{c}_lost_sd_kpa`` (kPa; what was lost in this drive, NaN while that is not counted
        and where the tire was low before that), ``{c}_cold_pressure_kpa``, ``{c}_cold_pressure_sd_kpa`` (kPa; what the tire would have
        cold, where the drive has ``ambient_temperature_c``) and ``{c}_state`` (``fine``, ``low``,
        ``over``, ``malfunction``, ``uncertain`` where there is a pressure that could be low as well as not, or ``unknown``).
        A drive with the speeds of four wheels has, per corner, ``{c}_radius_change`` (of the rolling radius since the calibration),
        ``{c}_lost_share`` (of its pressure, against the other tires), both with ``_sd``, ``{c}_low_probability``, and
        ``front_radius_difference`` (left over right), ``rear_radius_difference``, ``axles_radius_difference`` with ``_sd``; beside
        accelerations ``{c}_wheel_speed_state``, alone ``{c}_valid``, ``{c}_warning``, ``{c}_level`` (``other-tires``) and ``{c}_state``.
        ``rate_hz`` rows per second; a row uses samples up to its time. The same numbers as in ``itpms estimate -o``.

        Args:
            kind: ``pandas``, ``polars``, ``pyarrow`` or ``dict`` (of arrays; ``numpy`` is the same).

        Raises:
            SettingError: the library is not installed.
        """
        return table_of(self.columns, kind or self._kind)

    @property
    def road(self) -> Any:
        """The road under each wheel at the log's rate, as a table like :meth:`frame`.

        Columns: ``time_s``, ``distance_m``, then ``{c}_road_m`` and ``{c}_road_sd_m`` (m).

        Raises:
            SettingError: it was not asked for.
        """
        columns = self._inner.road()
        if columns is None:
            raise SettingError("the road was not kept, expected estimate(..., road=True)")
        return table_of(unpacked(columns), self._kind)

    @property
    def road_map(self) -> dict[str, Any]:
        """The road as GeoJSON, as ``itpms roughness --geojson`` writes it: lines of 100 m with their roughness, points of holes and bumps.

        Raises:
            SettingError: it was not asked for: where the car was is in no other result.
        """
        road = self._inner.road_map()
        if road is None:
            raise SettingError("the road's map was not kept, expected estimate(..., road_map=True)")
        found: dict[str, Any] = json.loads(road)
        return found

    @property
    def events(self) -> list[dict[str, Any]]:
        """Warnings and malfunctions as they came and went, in order: the objects of ``itpms estimate --events``."""
        found: list[dict[str, Any]] = json.loads(self._inner.transitions())
        return found

    @property
    def alerts(self) -> list[dict[str, Any]]:
        """The alerts of the drive, each with the time at which it was taken back (``ended_s``), if it was."""
        found: list[dict[str, Any]] = self.summary["alerts"]
        return found

    @property
    def dampers(self) -> dict[str, dict[str, Any]]:
        """What the drive says of each damper against the calibration's, by corner; empty where not all four corners are measured.

        Of each: ``damping_n_s_per_m`` (N s/m, with ``damping_sd_n_s_per_m``), ``over_reference`` (1: as it was), ``left_right`` and
        ``front_rear`` (shares; 0: alike), ``wheel_damping_ratio``, each with ``..._sd``, ``state`` (``learning``, ``fine``, ``weak``,
        ``worn``, ``stiff`` or ``unknown``) and ``because`` (why it is not known); None: not known. ``pandas.DataFrame(result.dampers).T``
        is a table of them.
        """
        found: dict[str, dict[str, Any]] = self.summary.get("dampers") or {}
        return found

    @property
    def load(self) -> dict[str, Any]:
        """What the axles carry, wheels included, in kg of the vehicle file; empty where not all four corners are measured.

        ``front_axle_kg``, ``rear_axle_kg``, ``total_kg``, ``added_kg`` (more than in the calibration drive) with ``front_axle_sd_kg``
        and so on, ``state`` (``known``, ``overload``, ``learning`` or ``unknown``) and ``because`` (why it is not known); None: not
        known.
        """
        found: dict[str, Any] = self.summary.get("load") or {}
        return found

    @property
    def cold(self) -> dict[str, dict[str, Any]]:
        """What each tire would have once it had cooled down to the air, by corner; empty where the drive has no ``ambient_temperature_c``.

        ``pressure_kpa``, ``sd_kpa``, ``ambient_temperature_c``, ``add_kpa`` (None: nothing) and ``state`` (``add``, ``fine`` or
        ``unknown``).
        """
        corners: dict[str, dict[str, Any]] = self.summary["corners"]
        return {name: corner["cold"] for name, corner in corners.items() if "cold" in corner}

    @property
    def once_per_turn(self) -> dict[str, dict[str, Any]]:
        """The force that turns with each wheel, by corner; empty of wheel speeds alone.

        ``force_n`` at ``at_rad_per_s``, ``imbalance_g`` (only where speeds were swept), ``rise_n``, each with ``force_sd_n`` and so on,
        ``since_s`` and ``state`` (``slow``, ``no-line``, ``found`` or ``rising``); None: not known.
        """
        found: dict[str, dict[str, Any]] = self.summary.get("once_per_turn") or {}
        return found

    @property
    def tire_sensors(self) -> dict[str, dict[str, Any]]:
        """What the drive says of the tires' own sensors, by corner; empty where none sends anything.

        ``pressure_kpa``, ``lost_kpa``, ``lost_kpa_per_h``, ``against_estimate_kpa``, each but the first with ``lost_sd_kpa`` and so on,
        ``since_s`` and ``state`` (``learning``, ``fine``, ``leak``, ``drift`` or ``stuck``); None: not known.
        """
        found: dict[str, dict[str, Any]] = self.summary.get("tire_sensors") or {}
        return found

    @property
    def concerns(self) -> list[str]:
        """What should be known before believing the result, a sentence each."""
        found: list[str] = self.summary["warnings"]
        return found

    def report(self, path: str | PathLike[str]) -> None:
        """Writes the page about the drive (HTML, complete in itself): that of ``itpms estimate --report``.

        Raises:
            SettingError: it was not kept: ``estimate(..., report=False)``.
            OutputError: the file cannot be written.
        """
        page = self._inner.page()
        if page is None:
            raise SettingError("the report was not kept, expected estimate(..., report=True)")
        write(path, page.encode())

    def plot(self) -> Figure:
        """The pressures over time with their 95 % bands, the placard's, and the truth where the drive has it.

        Of wheel speeds alone the share of its pressure that each tire has lost since the calibration, against the other tires, with its
        95 % band, and the smallest loss that would have shown.

        Needs matplotlib (``pip install matplotlib``). Returns the figure; show or save it.

        Raises:
            SettingError: matplotlib is not installed.
        """
        from ._plot import losses, pressures

        if not self.corners:
            return losses(self.columns)
        placards = {name: corner["placard_kpa"] for name, corner in self.summary["corners"].items()}
        return pressures(self.columns, placards, None if self._source is None else columns_of(self._source))

    def __reduce__(self) -> tuple[type[Result], tuple[Kept, Kind, Any]]:
        return Result, (Kept.of(self._inner), self._kind, self._source)

    def __repr__(self) -> str:
        drive = self.summary
        lines = [f"<itpms.Result {drive['duration_s']:.1f} s, {drive['estimator']}, {drive['vehicle']}"]
        lines += [f"  {line}" for line in self._inner.lines()]
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        """The same as a table, for notebooks."""
        keys = ("pressure_kpa", "sd_kpa", "time_s")
        head = "".join(f"<th>{escape(name)}</th>" for name in ("", "state", "kPa", "sd", "at (s)", "placard (kPa)"))
        rows = ""
        for name, corner in self.summary["corners"].items():
            last = corner["last"] or {}
            numbers = [last.get(key) for key in keys] + [corner["placard_kpa"]]
            cells = [name, corner["state"], *("-" if number is None else f"{number:.1f}" for number in numbers)]
            rows += "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in cells) + "</tr>"
        said = "".join(f"<li>{escape(line)}</li>" for line in self._inner.lines())
        title = f"{self.summary['vehicle']}, {self.summary['duration_s']:.1f} s"
        return f"<table><caption>{escape(title)}</caption><tr>{head}</tr>{rows}</table><ul>{said}</ul>"
