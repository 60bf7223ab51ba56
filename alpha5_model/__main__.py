"""``python -m alpha5_model`` is the same as ``alpha5``."""

from __future__ import annotations

import sys

from alpha5_model.errors import MissingDependencyError, needing


def run() -> None:
    """Run the command line, or say in one line which package it lacks."""
    try:
        remedy = "python -m pip install alpha5-model, without --no-deps"
        with needing("the command line", remedy):
            from alpha5_model.cli import run as run_command
    except MissingDependencyError as error:
        sys.exit(f"alpha5: {error}")
    run_command()


if __name__ == "__main__":
    run()
