// The formulas of any arm, with the dimensions and limits of this one.
const formulas = (() => {
  const { dimensions, shape, toolOnAxis } = data.own;
  const shapeNumbers = Object.values(shape).flat();
  const unused = data.statics.mass.map(() => 0); // bodies do not change where the links are
  const atRest = [...unused, ...dimensions];
  const solve = toolOnAxis ? own_formulas.inverse_kinematics_on_axis : own_formulas.inverse_kinematics_off_axis;
  return {
    forward_kinematics: (q) => own_formulas.forward_kinematics(q, atRest),
    jacobian: (q) => own_formulas.jacobian(q, atRest),
    link_poses: (q) => own_formulas.link_poses(q, atRest),
    hydrostatic_torque: (q, parameters) => own_formulas.hydrostatic_torque(q, [...parameters, ...dimensions]),
    inverse_kinematics: (position, wrist) => solve(position, wrist, shapeNumbers),
  };
})();
