"""Progress of long calls."""
from __future__ import annotations

import sys
import time
from typing import Callable, Optional, Union

OnProgress = Callable[[int, int], None]
"""Gets how much is done, and the total, 0 where that is not known."""
_WIDTH = 30


class _Bar:
    """A line on stderr, at most ten times a second."""

    def __init__(self, unit: str) -> None:
        self._unit = unit
        self._begin = time.monotonic()
        self._shown: Optional[float] = None

    def __call__(self, done: int, total: int) -> None:
        now = time.monotonic()
        is_end = 0 < total <= done
        if not is_end and self._shown is not None and now - self._shown < 0.1:
            return
        self._shown = now
        rate = done / max(now - self._begin, 1e-3)
        if total == 0:
            line = f"{done:,} {self._unit}, {rate:,.0f}/s"
        else:
            marks = "#" * (_WIDTH * done // total)
            line = f"[{marks:.<{_WIDTH}}] {done}/{total} {self._unit}, {rate:.1f}/s"
        print("\r" + line, end="\n" if is_end else "", file=sys.stderr, flush=True)


def reporter(progress: Union[bool, OnProgress], unit: str) -> OnProgress:
    """What to call: a bar for True, nothing for False, else the function itself."""
    if not isinstance(progress, bool):
        return progress
    if progress:
        return _Bar(unit)
    return lambda done, total: None
