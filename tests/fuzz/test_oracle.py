"""The oracle of the fuzz sees each failure that it looks for."""

from __future__ import annotations

import contextlib
import os
import pickle
import socket
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import oracle
import pytest
import watch

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, InputError


class UnpicklableError(Alpha5Error):
    def __reduce__(self) -> Any:
        raise TypeError("no")


def raising(error: BaseException) -> Any:
    raise error


def long_winded() -> Any:
    error = InputError("x", 1, "two")
    error.args = ("one\ntwo",)
    raise error


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: raising(KeyError("raw")), "KeyError"),
        (long_winded, "not one line"),
        (lambda: raising(UnpicklableError("x")), "does not pickle"),
        (lambda: {"a": (1.0, np.array([1.0, np.nan]))}, r"not finite: answer.a\[1\]"),
        (lambda: a5.dh.DHLink(0, 0, 0, 0), "not finite: answer.lower, answer.upper"),
        (lambda: sys.exit(3), "SystemExit"),
        (lambda: warnings.warn("odd", stacklevel=2), "UserWarning"),
    ],
)
def test_it_sees_a_wrong_outcome(call: Callable[[], Any], says: str) -> None:
    with pytest.raises(oracle.WrongOutcomeError, match=says):
        oracle.answer(call)


def test_it_sees_an_answer_that_should_be_none() -> None:
    assert oracle.answer(lambda: 1.0) == 1.0
    assert isinstance(oracle.answer(lambda: a5.reachable("x")), InputError)
    with pytest.raises(oracle.WrongOutcomeError, match="no meaning"):
        oracle.answer(lambda: 1.0, hopeless=True)
    with pytest.raises(oracle.WrongOutcomeError, match="without a word"):
        oracle.answer(lambda: 1.0, silent=False)


def test_it_sees_a_file_that_takes_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(oracle, "LONGEST_OF_FILES", 0.001)
    with pytest.raises(oracle.WrongOutcomeError, match="s for 10 bytes"):
        oracle.answer(lambda: sum(range(10**6)), size=10)


@pytest.mark.parametrize(
    ("act", "says"),
    [
        (lambda name: Path(name).read_text("utf-8"), "open"),
        (lambda name: os.system(f"true {name}"), "os.system"),
        (lambda name: subprocess.run(["true"], check=False), "subprocess.Popen"),
        (lambda name: eval(f"'{name}'"), "compile"),
        (lambda name: socket.socket().connect(("127.0.0.1", 9)), "socket.connect"),
        (lambda name: pickle.loads(pickle.dumps(os.getcwd)), "pickle.find_class"),
    ],
)
def test_it_sees_what_a_file_makes_it_do(act: Callable[[str], Any], says: str) -> None:
    def call() -> None:
        with contextlib.suppress(OSError):
            act(watch.CANARY)

    with pytest.raises(
        oracle.WrongOutcomeError, match=f"no input may make it do: {says}"
    ):
        oracle.answer(call)


def test_the_package_may_read_other_files_and_unpickle_its_records() -> None:
    record = pickle.dumps(a5.parameters())
    assert oracle.answer(lambda: pickle.loads(record).name) == "alpha5"
    assert oracle.answer(lambda: len(Path(os.devnull).read_bytes())) == 0
