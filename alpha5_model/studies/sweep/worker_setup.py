"""Set up a worker process on this machine; Dask imports this module in each of them."""

from __future__ import annotations

import signal


def dask_setup(worker: object) -> None:
    """Leave Ctrl-C, which goes to every process of a terminal, to the asking one.

    It ends the workers. Otherwise each would print what it was doing.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
