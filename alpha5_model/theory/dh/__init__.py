"""Serial arms in standard Denavit-Hartenberg parameters: links and chains.

``A_j = Rz(theta_j) Tz(d_j) Tx(a_j) Rx(alpha_j)`` maps coordinates in {j} to coordinates
in {j-1}. Joint j turns about (revolute, ``sigma = 0``) or slides along (prismatic,
``sigma = 1``) the axis ``z_{j-1}``; its variable is theta_j or d_j. A `DHChain` adds a
constant transform on either side, for rows of a table that no joint moves. For example,
the fixed last row of the arm's Table 1 is the ``tool`` of `DHChain.alpha5`. The matrix
printed in [Lecture7.1] lacks the minus sign of ``cos(theta) sin(alpha)`` in row 2; this
package uses the product of the four factors.

References:
    [Lecture7.1] Describing Robot Arms, section "Standard Denavit-Hartenberg
        parameters".
    [Corke2011] Corke: Robotics, Vision and Control, section 7.2, equation (7.2).
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, sections 2.8.2 and
        3.1.3.
    [ReachAlpha] Manufacturer's document, Section 1, Table 1.
"""

from alpha5_model.theory.dh.chain import DHChain, Frame
from alpha5_model.theory.dh.link import DHLink, dh_transform

__all__ = [
    "DHChain",
    "DHLink",
    "Frame",
    "dh_transform",
]
