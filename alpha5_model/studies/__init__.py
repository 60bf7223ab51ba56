"""Many states at once: uncertainty, identification, sweeps."""
