"""The arm's body: shapes with the printed volumes, drawn from a small table of dimensions."""
