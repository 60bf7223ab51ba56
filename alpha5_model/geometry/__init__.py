"""The shapes for collision, and how the bodies look."""
