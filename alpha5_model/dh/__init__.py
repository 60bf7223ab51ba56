"""Serial arms in standard Denavit-Hartenberg parameters."""

from alpha5_model.dh.chain import DHChain, Frame
from alpha5_model.dh.link import DHLink, dh_transform

__all__ = ["DHChain", "DHLink", "Frame", "dh_transform"]
