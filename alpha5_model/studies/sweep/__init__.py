"""Many states, cases or recordings, here or on a Dask cluster.

What is finished is kept, chunk by chunk. Workers compute, and the process that asked
writes: a worker that dies, or a chunk done twice, leaves nothing behind.
"""

from alpha5_model.studies.sweep.run import Sweep, sweep

__all__ = ["Sweep", "sweep"]
