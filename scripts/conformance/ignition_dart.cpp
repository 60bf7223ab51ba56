// Accelerations and link poses that ignition-physics' DART gives for states of the arm in an SDF world.
//
//   ignition_dart PLUGIN WORLD STATES
//
// STATES: a line per state, positions and velocities of axis_e, axis_d, axis_c, axis_b. Written to standard
// output: a line per state, four accelerations over one step and link_4's pose, 4x4 by rows.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <ignition/physics/ForwardStep.hh>
#include <ignition/physics/FrameSemantics.hh>
#include <ignition/physics/GetEntities.hh>
#include <ignition/physics/Joint.hh>
#include <ignition/physics/RequestEngine.hh>
#include <ignition/physics/sdf/ConstructWorld.hh>
#include <ignition/plugin/Loader.hh>
#include <sdf/Root.hh>
#include <sdf/World.hh>

namespace physics = ignition::physics;

struct Features
    : physics::FeatureList<physics::ForwardStep, physics::GetEntities, physics::GetBasicJointState,
                           physics::SetBasicJointState, physics::LinkFrameSemantics,
                           physics::sdf::ConstructSdfWorld> {};

int main(int count, char **arguments) {
  if (count != 4) return 2;
  ignition::plugin::Loader loader;
  loader.LoadLib(arguments[1]);
  auto plugin = loader.Instantiate("ignition::physics::dartsim::Plugin");
  auto engine = physics::RequestEngine3d<Features>::From(plugin);
  sdf::Root root;
  for (const auto &error : root.Load(arguments[2])) {
    std::cerr << error << "\n";
    return 1;
  }
  auto world = engine->ConstructWorld(*root.WorldByIndex(0));
  auto arm = world->GetModel(0);
  std::vector<physics::Joint3dPtr<Features>> joints;
  for (const char *name : {"axis_e", "axis_d", "axis_c", "axis_b"})
    joints.push_back(arm->GetJoint(name));
  auto last = arm->GetLink("link_4");

  std::ifstream states(arguments[3]);
  double q[4], v[4];
  while (states >> q[0] >> q[1] >> q[2] >> q[3] >> v[0] >> v[1] >> v[2] >> v[3]) {
    for (int i = 0; i < 4; ++i) {
      joints[i]->SetPosition(0, q[i]);
      joints[i]->SetVelocity(0, v[i]);
    }
    const Eigen::Matrix4d pose = last->FrameDataRelativeToWorld().pose.matrix();
    physics::ForwardStep::Output output;
    physics::ForwardStep::State state;
    physics::ForwardStep::Input input;
    world->Step(output, state, input);
    for (const auto &joint : joints) std::printf("%.17g ", joint->GetAcceleration(0));
    for (int i = 0; i < 16; ++i) std::printf("%.17g%c", pose(i / 4, i % 4), i < 15 ? ' ' : '\n');
  }
}
