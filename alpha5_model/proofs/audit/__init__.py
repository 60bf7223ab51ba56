"""The audit: the claims of the documents against the documents' own numbers."""

from alpha5_model.proofs.audit.run import (
    audit,
)

__all__ = [
    "audit",
]
