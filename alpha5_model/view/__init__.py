"""For eyes: pictures and the viewer. No physics in here."""
