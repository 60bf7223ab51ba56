"""The ``alpha5`` command: one module per subcommand, no physics in here."""

from alpha5_model.cli.main import main, run

__all__ = ["main", "run"]
