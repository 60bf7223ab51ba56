"""Calibration from your own measurements: which poses to take, and what they say."""

__all__: list[str] = []
