"""The drawn bodies."""
