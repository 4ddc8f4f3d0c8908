# What the suite runs in: `source environment.bash`, then `robots`, `cell`, `simulate`, `ros2 run` or Python.
#
# ROS 2 where it is installed (ROS_DISTRO_SETUP), the workspace, and .venv before both: ROS may bring another
# Pinocchio, whose modules and libraries would be taken for the one that the suite is made for.
_root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
_options=$(set +o | grep nounset)
set +u # the setup files ask for variables that may be unset

if [ -f "${ROS_DISTRO_SETUP:=/opt/ros/jazzy/setup.bash}" ]; then
  source "$ROS_DISTRO_SETUP"
fi
if [ -f "$_root/install/setup.bash" ]; then
  source "$_root/install/setup.bash"
fi
if [ -f "$ROS_DISTRO_SETUP" ]; then
  _packages=$("$_root/.venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
  _pinocchio="$_packages/cmeel.prefix/lib"
  export PYTHONPATH="$_pinocchio/$(basename "$(dirname "$_packages")")/site-packages:$_packages${PYTHONPATH:+:$PYTHONPATH}"
  export LD_LIBRARY_PATH="$_pinocchio${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
fi
export PATH="$_root/.venv/bin:$_root/install/robots_controller/lib/robots_controller:$_root/install/robots_core/lib/robots_core:$PATH"

# The command line is completed by `robots` and by each command below it.
case $- in
*i*) eval "$(robots --completion bash 2>/dev/null || true)" ;;
esac

eval "$_options"
unset _root _options _packages _pinocchio
