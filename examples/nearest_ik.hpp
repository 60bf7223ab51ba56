// The closed-form inverse kinematics as a MoveIt plugin would call it: the nearest solution.
//
//   alpha5 generate c --output alpha5_c
//   cc -std=c99 -c alpha5_c/alpha5.c
//   c++ -std=c++17 -I alpha5_c my_plugin.cpp alpha5.o
//
// axis_b turns the tool about its own axis and does not move the tcp, so the wrist stays where the seed has it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "alpha5.h"

namespace alpha5 {

using Joints = std::array<alpha5_real, 4>;  // axis_e, axis_d, axis_c, axis_b [rad]

// The branch within the limits whose largest joint motion from the seed is smallest; none if none exists.
inline std::optional<Joints> nearest(const std::array<alpha5_real, 3>& tcp, const Joints& seed) {
  alpha5_real branches[4][4];
  int exists[4], within_limits[4], singular;
  alpha5_inverse_kinematics(tcp.data(), seed[3], branches, exists, within_limits, &singular);

  std::optional<Joints> best;
  alpha5_real smallest = INFINITY;
  for (int branch = 0; branch < 4; ++branch) {
    if (!exists[branch] || !within_limits[branch]) continue;
    Joints q;
    alpha5_real largest = 0;
    for (int joint = 0; joint < 4; ++joint) {
      q[joint] = branches[branch][joint];
      largest = std::max(largest, std::abs(q[joint] - seed[joint]));
    }
    if (largest < smallest) {
      smallest = largest;
      best = q;
    }
  }
  return best;
}

}  // namespace alpha5
