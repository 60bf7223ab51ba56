"""The model in the shapes in which the collections of robot models hold theirs."""
