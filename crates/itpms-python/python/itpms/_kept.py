"""What is kept of a drive when its result is pickled: all that it shows, without the estimator's own memory."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any

from . import _itpms
from ._errors import SettingError


@dataclass(frozen=True)
class Kept:
    """Answers as :class:`itpms._itpms.Estimated` does, from answers that were taken down."""

    answers: dict[str, Any]

    @classmethod
    def of(cls, inner: _itpms.Estimated | Kept) -> Kept:
        """What the result of a drive, or one that was kept before, has to say."""
        if isinstance(inner, Kept):
            return inner
        return cls({name: getattr(inner, name)() for name in ASKED})

    def __getattr__(self, name: str) -> Any:
        if name in ASKED:
            return lambda: self.answers[name]
        raise AttributeError(name)

    def teach(self, path: str | PathLike[str]) -> str | None:
        """A calibration is stored where it was driven."""
        raise SettingError(f"{path}: a result that was pickled teaches no car, expected it before, or save_reference=")


ASKED = (
    "estimates",
    "warnings",
    "road",
    "road_map",
    "transitions",
    "figures",
    "wheels",
    "start_s",
    "corners",
    "lines",
    "page",
)
