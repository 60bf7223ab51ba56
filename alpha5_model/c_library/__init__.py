"""The arm's equations as a C99 library."""
