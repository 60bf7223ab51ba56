"""The model as a member of robot_descriptions and of example-robot-data."""
