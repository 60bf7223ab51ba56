"""Samples of joint positions, and ranks of Jacobians, for an arm of any size."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model._support.checks import count as whole_number
from alpha5_model.theory.dh.chain import DHChain

#: Singular values below this count as zero; lengths are divided by the arm's size
#: first.
RANK_TOLERANCE = 1e-8


def sample_configurations(
    chain: DHChain, count: int, rng: np.random.Generator
) -> FloatArray:
    """Uniform joint positions within the limits, (count, N); see `task_capability`."""
    whole_number("count", count)
    instance("rng", rng, np.random.Generator)
    size = chain_size(chain)
    span = np.where(np.array(chain.sigma) == 0, math.pi, size)
    # A joint with one limit is sampled over the same width from that limit.
    least = np.where(np.isfinite(chain.upper), chain.upper - 2 * span, -span)
    lower = np.where(np.isfinite(chain.lower), chain.lower, least)
    upper = np.where(np.isfinite(chain.upper), chain.upper, lower + 2 * span)
    return np.asarray(rng.uniform(lower, upper, (count, chain.n)))


def chain_size(chain: DHChain) -> float:
    """A length of the order of the arm's reach, which scales metres to radians [m]."""
    total = float(np.linalg.norm(instance("chain", chain, DHChain).tool[:3, 3]))
    for link in chain.links:
        travel = (link.lower, link.upper, link.d) if link.sigma else (link.d,)
        farthest = max(abs(x) for x in travel if math.isfinite(x))
        total += abs(link.a) + farthest
    return total or 1.0


def jacobian_scale(chain: DHChain) -> FloatArray:
    """Scale of each row of a Jacobian, (6, 1), by which to divide.

    It is the arm's size for the linear rows, and 1 for the angular rows.
    """
    return np.array([chain_size(chain)] * 3 + [1.0] * 3)[:, None]


#: Numerical rank of (..., m, n) whose entries are of order 1.
matrix_rank = partial(np.linalg.matrix_rank, tol=RANK_TOLERANCE)
