#!/usr/bin/env bash
# Install, where Debian's apt is, the tools that people run, then run them on the package: one table.
#   scripts/conformance/real_tools.sh PYTHON [arguments of real_tools.py]
set -euo pipefail
cd "$(dirname "$0")/../.."
python=$1
shift

packages="
  colcon python3-colcon-cmake python3-colcon-output python3-colcon-package-selection
  python3-colcon-recursive-crawl python3-colcon-ros ament-cmake cmake
  liburdfdom-tools
  python3-roslaunch ros-robot-state-publisher python3-rospy python3-tf2-ros python3-sensor-msgs
  rviz xvfb
  ignition-tools libsdformat-dev sdformat-sdf
  libignition-physics-dev libignition-physics5-dartsim-plugin5 libignition-plugin-dev g++ pkg-config
"
if command -v apt-get >/dev/null && [ "$(id -u)" = 0 ]; then
  # shellcheck disable=SC2086
  if ! dpkg -s $packages >/dev/null 2>&1; then
    retry=(bash scripts/checks/retry.sh)
    export DEBIAN_FRONTEND=noninteractive
    if ! { "${retry[@]}" apt-get update -qq &&
      "${retry[@]}" apt-get install -y -qq --no-install-recommends $packages >/dev/null; }; then
      echo "some of Debian's packages did not install: see the table"
    fi
  fi
fi

exec "$python" scripts/conformance/real_tools.py "$@"
