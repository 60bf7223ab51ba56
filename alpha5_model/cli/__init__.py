"""The ``alpha5`` command: one module per subcommand, no physics in here."""

from alpha5_model.cli.commands import (
    COMMANDS,
    application,
)
from alpha5_model.cli.program import (
    main,
    run,
)

__all__ = [
    "COMMANDS",
    "application",
    "main",
    "run",
]
