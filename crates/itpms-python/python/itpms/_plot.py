"""The pressures as a figure. Only here matplotlib is needed."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np

from ._errors import SettingError
from ._tables import Columns, numbers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._result import Result

# A log that begins later than this counts from some epoch.
DAY_S = 86_400.0
NAMES = {"fl": "Front left", "fr": "Front right", "rl": "Rear left", "rr": "Rear right"}
# Okabe and Ito, as in the program's own figures.
ESTIMATE, TRUTH, LOW, PLACARD = "#0067a8", "#1b1b1b", "#d0560a", "#6b7280"


def pressures(result: Result, source: Columns | None) -> Figure:
    """A panel per corner, all with the same axes."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise SettingError("matplotlib is not installed, expected pip install itpms[plot]") from None

    class Picture(Figure):
        """A figure of nobody's window, which a notebook shows all the same."""

        def _repr_png_(self) -> bytes:
            shown = io.BytesIO()
            self.savefig(shown, format="png", dpi=90)
            return shown.getvalue()

    corners, columns = result.corners, result.columns
    across = min(len(corners), 2)
    down = -(-len(corners) // across)
    figure = Picture(figsize=(5.2 * across, 3.0 * down), layout="constrained")
    panels = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
    # Seconds since 1970 tell a reader nothing.
    origin_s = columns["time_s"][0] if abs(columns["time_s"][0]) > DAY_S else 0.0
    time_s = columns["time_s"] - origin_s
    for panel, corner in zip(panels.flat, corners, strict=False):
        pressure, sd = columns[f"{corner}_pressure_kpa"], columns[f"{corner}_pressure_sd_kpa"]
        valid = columns[f"{corner}_valid"]
        shown = np.where(valid, pressure, np.nan)
        panel.fill_between(
            time_s, shown - 1.96 * sd, shown + 1.96 * sd, color=ESTIMATE, alpha=0.2, lw=0, label="95 % band"
        )
        panel.plot(time_s, np.where(valid, np.nan, pressure), color=ESTIMATE, lw=0.8, ls=":", label="not valid")
        panel.plot(time_s, shown, color=ESTIMATE, lw=1.5, label="estimate")
        low = columns[f"{corner}_warning"] == "low"
        if low.any():
            panel.fill_between(
                time_s, 0, 1, where=low, color=LOW, alpha=0.12, lw=0, transform=panel.get_xaxis_transform(), label="low"
            )
        truth = f"{corner}_pressure_kpa"
        if source is not None and {truth, "time_s"} <= source.keys():
            panel.plot(
                numbers("time_s", source["time_s"]) - origin_s,
                numbers(truth, source[truth]),
                color=TRUTH,
                lw=1,
                label="truth",
            )
        panel.axhline(result.summary["corners"][corner]["placard_kpa"], color=PLACARD, lw=0.8, ls="--", label="placard")
        panel.set_title(NAMES[corner], loc="left", fontsize=10, fontweight="bold")
        panel.spines[["top", "right"]].set_visible(False)
    for panel in panels[-1]:
        panel.set_xlabel("Time since the start (s)" if origin_s else "Time (s)")
    for panel in panels[:, 0]:
        panel.set_ylabel("Pressure (kPa)")
    handles, labels = {}, []
    for panel in panels.flat:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            if label not in handles:
                handles[label] = handle
                labels.append(label)
    figure.legend(
        [handles[label] for label in labels],
        labels,
        loc="outside upper center",
        ncols=len(labels),
        frameon=False,
        fontsize=9,
    )
    return figure
