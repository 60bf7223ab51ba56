"""Does the document agree with itself? See `alpha5_model.audit`."""
