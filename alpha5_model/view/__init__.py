"""For eyes: pictures and pages, no physics."""
