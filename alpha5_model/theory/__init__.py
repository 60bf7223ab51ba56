"""The lecture notes: Denavit-Hartenberg chains and planar arms."""
