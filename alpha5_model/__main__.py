"""``python -m alpha5_model`` is the same as ``alpha5``."""

from alpha5_model.cli import run

if __name__ == "__main__":
    run()
