"""How far a computation is, shown by tqdm: in a notebook where it is installed, elsewhere where it is asked for."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ._errors import SettingError

# A bar for what is done sooner would only flicker.
DELAY_S = 0.5

Told = Callable[[float], None]


@contextmanager
def progress_bar(wanted: bool | None, what: str) -> Iterator[Told | None]:
    """What the extension tells the share that is done, 0 to 1; None where nobody wants to see it."""
    bar = _bar(wanted, what)
    if bar is None:
        yield None
        return
    with bar:
        yield lambda share: _advance(bar, share)
        _advance(bar, 1.0)


def _advance(bar: Any, share: float) -> None:
    bar.update(share - bar.n)


def _bar(wanted: bool | None, what: str) -> Any:
    if wanted is False or (wanted is None and not _in_notebook()):
        return None
    try:
        with warnings.catch_warnings():
            # A notebook without ipywidgets gets a bar of letters.
            warnings.simplefilter("ignore")
            from tqdm.auto import tqdm
    except ImportError:
        if wanted is None:
            return None
        raise SettingError("progress=True: tqdm is not installed, expected pip install tqdm") from None
    return tqdm(total=1.0, desc=what, delay=DELAY_S, leave=False, bar_format="{l_bar}{bar}| {elapsed}<{remaining}")


def _in_notebook() -> bool:
    # Who sits in a notebook has imported it.
    shell = sys.modules.get("IPython")
    running = shell.get_ipython() if shell is not None else None
    return running is not None and "IPKernelApp" in running.config
