"""The arm as files: xacro parameters, URDF, meshes, and proof that they say what the tables say."""
