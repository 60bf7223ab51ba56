"""What the model rests on in MuJoCo, each by a formula: a release may change it.

Between 3.3.5 and 3.4.0 the force of ``gravcomp`` on a body without a joint changed;
4.0.1 mends accelerations with sparse Jacobians.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from lazily import Lazy

from alpha5_model._support.paths import MJCF_PATH

mujoco = Lazy("mujoco", minversion="3.5", reason="MuJoCo 3.5 or later")

#: A hinge along y that carries a rod, and at its end a body with gravcomp.
PENDULUM = """
<mujoco>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <body name="rod">
      <joint name="hinge" axis="0 1 0"/>
      <inertial pos="0.1 0 0" mass="0.5" diaginertia="1e-3 2e-3 2e-3"/>
      <body name="float" pos="{lever} 0 0" gravcomp="{factor}">
        <inertial pos="0 0 0" mass="{mass}" diaginertia="2e-10 2e-10 2e-10"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("displaced", [0.0, 0.2, 0.9])
@pytest.mark.parametrize("angle", [-0.7, 0.0, 1.2])
def test_gravcomp_of_a_body_without_a_joint_is_its_force(displaced, angle):
    """The mass is negligible; the factor makes the weight of the displaced water."""
    mass, lever = 1e-13, 0.3
    text = PENDULUM.format(lever=lever, mass=mass, factor=displaced / mass + 1.0)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[0] = angle
    mujoco.mj_forward(model, data)
    # About +y, a force up at +x turns backwards.
    buoyancy = -displaced * 9.81 * lever * np.cos(angle)
    weight = 0.5 * 9.81 * 0.1 * np.cos(angle)
    inertia = 2e-3 + 0.5 * 0.1**2 + 2e-10
    np.testing.assert_allclose(data.qfrc_passive[0], buoyancy, atol=1e-12)
    np.testing.assert_allclose(data.qacc[0], (weight + buoyancy) / inertia, rtol=1e-9)


@pytest.mark.parametrize("name", ["alpha5", "alpha5_jaws", "alpha5_mjx"])
def test_sparse_and_dense_jacobians_give_the_same_accelerations(name):
    """At contacts, limits and the equality of the fingers."""
    path = str(Path(MJCF_PATH).with_name(f"{name}.xml"))
    accelerations = []
    constraints = 0
    for kind in (mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE):
        model = mujoco.MjModel.from_xml_path(path)
        model.opt.jacobian = kind
        data = mujoco.MjData(model)
        rng = np.random.default_rng(3767)
        rows = []
        for _ in range(40):
            mujoco.mj_resetDataKeyframe(model, data, 0)
            data.qpos[:4] += rng.normal(0.0, 0.8, 4)
            data.qvel[:] = rng.normal(0.0, 1.0, model.nv)
            mujoco.mj_forward(model, data)
            constraints += data.nefc
            rows.append(data.qacc.copy())
        accelerations.append(np.array(rows))
    dense, sparse = accelerations
    assert constraints > 20
    scale = np.abs(dense).max(axis=1, keepdims=True)
    assert np.all(np.abs(sparse - dense) <= 1e-11 * scale)
