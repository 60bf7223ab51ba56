"""Modules and files for the robot loaders of other packages."""
