"""Batches and errors in processes that are forked after threads ran, or spawned."""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from dynamics_cases import make, random_q, random_v

import alpha5_model as a5
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.torque_causes import torque_terms

LIMIT = 120.0  # [s]; without one, a child that hangs would hang the tests
MANY = 2 * batch.STATES_PER_THREAD + 1


def states(arm, count=MANY):
    rng = np.random.default_rng(7)
    ramp = np.linspace(0.1, 1.0, count)[:, None]
    q = np.tile(random_q(arm, rng), (count, 1))
    angles = slice(-5, -1) if "axis_a" in arm.joint_names else slice(-4, None)
    q[:, angles] += ramp
    return q, random_v(arm, rng) * ramp, random_v(arm, rng) * ramp


def answers(kind):
    """Every batch of an arm, more states than one thread is given."""
    arm = make(kind)
    q, v, a = states(arm)
    terms = (
        [] if arm.floating_base else [torque_terms(arm, q, v, a, threads=2).coriolis]
    )
    return [
        arm.inverse_dynamics_batch(q, v, a, threads=2),
        arm.forward_dynamics_batch(q, v, a),
        arm.base_wrench_batch(q, v, a, threads=2),
        arm.inverse_dynamics(q[0], v[0], a[0]),
        *terms,
    ]


def refused(_):
    a5.load().inverse_dynamics(
        np.zeros(4), np.array([0.0, np.nan, 0.0, 0.0]), np.zeros(4)
    )


@pytest.fixture(params=["fork", "spawn"])
def context(request):
    if request.param not in multiprocessing.get_all_start_methods():
        pytest.skip(f"no {request.param} on this system")
    answers("locked")  # this process has threads of its own before it forks
    return multiprocessing.get_context(request.param)


def same(ours, theirs):
    return all(
        np.allclose(x, y, rtol=1e-12, atol=1e-12)
        for x, y in zip(ours, theirs, strict=True)
    )


@pytest.mark.parametrize("kind", ["locked", "floating", "jaws"])
def test_threads_change_no_answer(kind):
    arm = make(kind)
    q, v, a = states(arm)
    one, two = (arm.inverse_dynamics_batch(q, v, a, threads=n) for n in (1, 2))
    np.testing.assert_allclose(two, one, rtol=1e-12, atol=1e-12)
    for i in (0, MANY - 1):
        gap = np.abs(two[i] - arm.inverse_dynamics(q[i], v[i], a[i])).max()
        assert gap < 1e-12 * max(1.0, np.abs(two[i]).max())


@pytest.mark.slow
def test_batches_and_errors_in_a_pool_s_workers(context):
    kinds = ["locked", "floating", "jaws"]
    with context.Pool(1) as pool:
        there = pool.map_async(answers, kinds).get(LIMIT)
        with pytest.raises(a5.errors.NonFiniteError) as caught:
            pool.apply_async(refused, (0,)).get(LIMIT)
    assert (caught.value.name, caught.value.index) == ("v", (1,))
    assert all(same(x, answers(kind)) for x, kind in zip(there, kinds, strict=True))


@pytest.mark.slow
def test_an_error_leaves_an_executor_s_worker_and_the_worker_goes_on(context):
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        failed = pool.submit(refused, 0)
        with pytest.raises(a5.errors.NonFiniteError):
            failed.result(LIMIT)
        assert same(pool.submit(answers, "locked").result(LIMIT), answers("locked"))


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_child_and_its_child_use_one_thread():
    def child(send):
        if os.fork() == 0:  # a grandchild
            send.send(batch.thread_count(4, 10**6))
            os._exit(0)
        os.wait()
        send.send(batch.thread_count(None, 10**6))

    context = multiprocessing.get_context("fork")
    receive, send = context.Pipe(duplex=False)
    process = context.Process(target=child, args=(send,))
    process.start()
    process.join(LIMIT)
    assert process.exitcode == 0
    assert [receive.recv(), receive.recv()] == [1, 1]
    with pytest.raises(a5.errors.InputError):
        batch.thread_count(0, 1)


def test_threads_go_by_the_size_of_the_batch(monkeypatch):
    n = batch.STATES_PER_THREAD
    counts = {
        (8, 0): 1,
        (8, 1): 1,
        (8, n): 1,
        (8, 2 * n - 1): 1,
        (8, 2 * n): 2,
        (8, 99 * n): 8,
        (3, 99 * n): 3,
    }
    assert {case: batch.thread_count(*case) for case in counts} == counts
    monkeypatch.setattr(batch, "available_threads", lambda: 5)
    assert batch.thread_count(None, 99 * n) == 5
