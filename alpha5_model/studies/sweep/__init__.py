"""Many states, cases or recordings, here or on a Dask cluster.

A study is computed in parts, and each finished part is a file. Workers compute, and the
process that asked writes: a worker that dies leaves nothing behind.
"""

from alpha5_model.studies.sweep.run import Sweep, sweep

__all__ = ["Sweep", "sweep"]
