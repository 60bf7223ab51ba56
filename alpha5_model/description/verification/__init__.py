"""Proof that a URDF of the arm says what the document's tables say.

Every check reads the file anew and compares it with the printed tables by a second
route. Numbers in the text are compared with the printed digits. Frames that other tools
compute are compared with the product of Table 1's rows, which the generator of the file
does not use. If a tool is not installed, its row says ``not run``, which does not count
as passed.
"""

from alpha5_model.description.verification.checks import verify_generated, verify_urdf
from alpha5_model.description.verification.subject import FileCheck

__all__ = ["FileCheck", "verify_generated", "verify_urdf"]
