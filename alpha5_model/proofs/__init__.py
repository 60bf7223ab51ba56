"""The audit of the documents, and the comparison of other models."""
