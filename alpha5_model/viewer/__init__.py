"""The arm in a browser, on a page, in a picture; plots of workspaces and motions."""

from alpha5_model.viewer.show import (
    view,
)

__all__ = [
    "view",
]
