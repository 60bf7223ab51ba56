"""Self-collision of an arm: exact, and by tables whose answer is proved."""
