"""The audit: claims of the documents, checked with the documents' own numbers."""

from alpha5_model.proofs.audit.run import (
    audit,
)

__all__ = [
    "audit",
]
