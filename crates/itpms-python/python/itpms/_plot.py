"""Figures. Only here matplotlib is needed."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import SettingError
from ._tables import Columns, numbers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# A log that begins later than this counts from some epoch.
DAY_S = 86_400.0
NAMES = {"fl": "Front left", "fr": "Front right", "rl": "Rear left", "rr": "Rear right"}
# Okabe and Ito, as in the program's own figures.
ESTIMATE, TRUTH, LOW, PLACARD = "#0067a8", "#1b1b1b", "#d0560a", "#6b7280"


def _figure(width: float, height: float) -> Figure:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise SettingError("matplotlib is not installed, expected pip install matplotlib") from None

    class Picture(Figure):
        """A figure of nobody's window, which a notebook shows all the same."""

        def _repr_png_(self) -> bytes:
            shown = io.BytesIO()
            self.savefig(shown, format="png", dpi=90)
            return shown.getvalue()

    return Picture(figsize=(width, height), layout="constrained")


def _legend(figure: Figure) -> None:
    """One legend for all panels, above them."""
    handles: dict[str, Any] = {}
    for panel in figure.axes:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    figure.legend(
        list(handles.values()),
        list(handles),
        loc="outside upper center",
        ncols=len(handles),
        frameon=False,
        fontsize=9,
    )


def pressures(columns: Columns, placards_kpa: dict[str, float], source: Columns | None) -> Figure:
    """A panel per corner, all with the same axes. ``columns`` are estimates; ``source`` is the drive, where it was a table."""
    corners = list(placards_kpa)
    across = min(len(corners), 2)
    down = -(-len(corners) // across)
    figure = _figure(5.2 * across, 3.0 * down)
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
        panel.axhline(placards_kpa[corner], color=PLACARD, lw=0.8, ls="--", label="placard")
        panel.set_title(NAMES[corner], loc="left", fontsize=10, fontweight="bold")
        panel.spines[["top", "right"]].set_visible(False)
    for panel in panels[-1]:
        panel.set_xlabel("Time since the start (s)" if origin_s else "Time (s)")
    for panel in panels[:, 0]:
        panel.set_ylabel("Pressure (kPa)")
    _legend(figure)
    return figure


def losses(columns: Columns) -> Figure:
    """A panel per wheel with the result of wheel speeds alone: its loss, and the smallest detectable loss."""
    figure = _figure(10.4, 6.0)
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    origin_s = columns["time_s"][0] if abs(columns["time_s"][0]) > DAY_S else 0.0
    time_s = columns["time_s"] - origin_s
    highest = 40.0
    for panel, corner in zip(panels.flat, NAMES, strict=True):
        lost, sd, shows = (
            100.0 * columns[f"{corner}_{name}"] for name in ("lost_share", "lost_share_sd", "detectable_loss")
        )
        upper = np.minimum(lost + 1.96 * sd, 100.0)
        panel.fill_between(
            time_s, np.maximum(lost - 1.96 * sd, 0.0), upper, color=ESTIMATE, alpha=0.2, lw=0, label="95 % band"
        )
        panel.plot(time_s, lost, color=ESTIMATE, lw=1.5, label="lost")
        panel.plot(time_s, shows, color=PLACARD, lw=1, ls="--", label="smallest loss that would have shown")
        low = columns[f"{corner}_warning"] == "low"
        if low.any():
            panel.fill_between(
                time_s, 0, 1, where=low, color=LOW, alpha=0.12, lw=0, transform=panel.get_xaxis_transform(), label="low"
            )
        if not np.isfinite(lost).any():
            panel.text(0.5, 0.5, "not compared: no calibration", transform=panel.transAxes, ha="center", color=PLACARD)
        else:
            highest = max(highest, float(np.nanmax(upper)))
        panel.set_title(NAMES[corner], loc="left", fontsize=10, fontweight="bold")
        panel.spines[["top", "right"]].set_visible(False)
    panels[0, 0].set_ylim(0.0, min(highest, 100.0))
    for panel in panels[-1]:
        panel.set_xlabel("Time since the start (s)" if origin_s else "Time (s)")
    for panel in panels[:, 0]:
        panel.set_ylabel("Lost of its pressure (%)")
    _legend(figure)
    return figure


def responses(curves: dict[str, Columns]) -> Figure:
    """A column of two panels per corner: how the body answers the wheel, and how coherently."""
    figure = _figure(3.6 * len(curves), 5.0)
    panels = figure.subplots(2, len(curves), sharex=True, sharey="row", squeeze=False, height_ratios=(2, 1))
    for (corner, of), (gain, coherence) in zip(curves.items(), panels.T, strict=True):
        gain.fill_between(
            of["file_hz"],
            of["file_gain_low"],
            of["file_gain_high"],
            color=PLACARD,
            alpha=0.25,
            lw=0,
            label="file, within a standard deviation",
        )
        gain.plot(of["file_hz"], of["file_gain"], color=TRUTH, lw=1.2, label="file")
        # What is not known to half of itself would look like a value.
        known = of["gain_se"] < 0.5 * of["gain"]
        gain.errorbar(
            of["hz"][known],
            of["gain"][known],
            of["gain_se"][known],
            color=ESTIMATE,
            fmt=".",
            ms=4,
            elinewidth=0.8,
            label="measured",
        )
        gain.set(xscale="log", yscale="log")
        gain.set_title(NAMES[corner], loc="left", fontsize=10, fontweight="bold")
        coherence.plot(of["hz"], of["coherence"], color=ESTIMATE, lw=1.2)
        coherence.axhline(0.5, color=PLACARD, lw=0.8, ls="--")
        coherence.set_ylim(0.0, 1.0)
        coherence.set_xlabel("Frequency (Hz)")
        # A decade in 2 to 25 Hz has one power of ten.
        coherence.set_xticks([2, 5, 10, 20], labels=["2", "5", "10", "20"])
        coherence.set_xticks([], minor=True)
        for panel in (gain, coherence):
            panel.spines[["top", "right"]].set_visible(False)
    panels[0, 0].set_ylabel("Body over wheel")
    panels[1, 0].set_ylabel("Coherence")
    _legend(figure)
    return figure
