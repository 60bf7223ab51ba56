"""Inputs that the package once answered wrongly, or refused with a foreign error."""

from __future__ import annotations


def test_an_empty_number_is_refused_in_one_line(capsys):
    from alpha5_model.cli import main

    assert main(["torque", "--q", "3", "1", "1", ""]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
