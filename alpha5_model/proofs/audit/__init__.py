"""The audit: every claim of the documents that their own numbers can be held against."""

from alpha5_model.proofs.audit.run import (
    audit,
)

__all__ = [
    "audit",
]
