"""The arm for other tools: URDF, xacro, MJCF, SDF, SRDF."""
