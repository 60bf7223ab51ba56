"""Another model of this arm held against ours: what differs, by how much, and why."""
