"""A vehicle file held against a drive."""

from __future__ import annotations

import json
from collections.abc import Iterator
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _itpms
from ._errors import SettingError
from ._pieces import TABLE, taken
from ._progress import progress_bar
from ._signals import Signals, Where, map_file, rows_where
from ._tables import Columns

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Checked:
    """What a drive says of a car's suspension. Made by :meth:`itpms.Vehicle.check`.

    Attributes:
        corners: By corner (``fl``, ``fr``, ``rl``, ``rr``): ``sentence`` (what was found and what to change), ``asks_for_change``,
            ``coherence`` (of body and wheel, 4 to 16 Hz, 0 to 1), ``damping_over_file`` and ``spring_over_file`` with their
            standard errors ``..._se`` (None where they cannot be told), and ``fit``: ``incoherence``, ``unexplained``,
            ``hop_excess``, ``friction_n`` (N) and ``misfit`` of the estimator at the end, as in ``Result.summary``.
        dampers: By corner, what is known without a calibration, with the keys of :attr:`Result.dampers`: ``left_right`` (left over right of
            the axle, less one), ``damping_n_s_per_m`` and ``wheel_damping_ratio``; empty where not all four corners are measured.
        concerns: What contradicts itself in the drive, and what was repaired, a sentence each.
    """

    def __init__(self, inner: _itpms.Checked) -> None:
        self._inner = inner
        document = json.loads(inner.document())
        self.corners: dict[str, dict[str, Any]] = document["corners"]
        self.dampers: dict[str, dict[str, Any]] = document["dampers"] or {}
        self.concerns: list[str] = inner.concerns()

    def curves(self, corner: str) -> Columns:
        """How the body answers the wheel of a corner, as arrays.

        Returns:
            ``hz``, ``gain`` (acceleration of the body over the wheel's, as measured), ``gain_se`` (its standard error) and
            ``coherence``, of shape (bins,); ``file_hz``, ``file_gain``, ``file_gain_low`` and
            ``file_gain_high`` (the vehicle file's, and within its standard deviations), of shape (points,).

        Raises:
            SettingError: the corner was not checked.
        """
        if corner not in self.corners:
            raise SettingError(f"corner is {corner!r}, expected one of: {', '.join(self.corners)}")
        return {name: np.array(values) for name, values in self._inner.curves(corner)}

    def plot(self) -> Figure:
        """Measured response, the file's with its band, and the coherence, a column of panels per corner.

        Needs matplotlib (``pip install matplotlib``). Returns the figure; show or save it.

        Raises:
            SettingError: matplotlib is not installed.
        """
        from ._plot import responses

        return responses({corner: self.curves(corner) for corner in self.corners})

    def report(self, path: str | PathLike[str]) -> None:
        """Writes the page with sentences and pictures (HTML, complete in itself): that of ``itpms vehicle check --report``.

        Raises:
            OutputError: the file cannot be written.
        """
        self._inner.report(path)

    def __repr__(self) -> str:
        lines = [f"  {name}  {corner['sentence']}" for name, corner in self.corners.items()]
        return "\n".join(["<itpms.Checked", *lines]) + ">"


def check(
    vehicle: _itpms.Vehicle,
    drive: Any,
    trust_units: bool,
    dbc: str | PathLike[str] | None,
    signals: Signals,
    where: Where,
    progress: bool | None,
) -> Checked:
    """What :meth:`itpms.Vehicle.check` does."""
    with progress_bar(progress, "checking") as told, map_file(signals) as path:
        if isinstance(drive, (str, PathLike)):
            return Checked(_itpms.check_log(drive, vehicle, trust_units, dbc, path, rows_where(where), told))
        if dbc is not None:
            raise SettingError("dbc says what the frames of a CAN log mean; this drive is a table")
        pieces, rows = taken(TABLE, drive, mapped=signals is not None)
        selected = rows_where(where)
        columns: Iterator[list[bytes | str]] = iter(pieces)
        return Checked(
            _itpms.check_pieces(TABLE, pieces.names, rows, columns, vehicle, trust_units, path, selected, told)
        )
