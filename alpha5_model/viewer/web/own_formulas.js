// The formulas of any arm, with the dimensions and limits of this one.
const formulas = (() => {
  const { dimensions, kinematics } = data.own;
  const unused = data.statics.mass.map(() => 0); // bodies do not change where the links are
  const atRest = [...unused, ...dimensions];
  return {
    forward_kinematics: (q) => own_formulas.forward_kinematics(q, atRest),
    jacobian: (q) => own_formulas.jacobian(q, atRest),
    link_poses: (q) => own_formulas.link_poses(q, atRest),
    hydrostatic_torque: (q, parameters) => own_formulas.hydrostatic_torque(q, [...parameters, ...dimensions]),
    inverse_kinematics: (position, wrist) => own_formulas.inverse_kinematics(position, wrist, kinematics),
  };
})();
