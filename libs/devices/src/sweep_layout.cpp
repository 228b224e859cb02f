#include "sweep_layout.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::devices {

void lay_out(Sweep sweep, bool upside_down, LaserScan& scan) {
  const auto gaps = static_cast<double>(sweep.ranges_m.size() - 1);
  scan.angle_step_rad = sweep.step_rad;
  scan.angle_min_rad = upside_down ? -(sweep.first_rad + gaps * sweep.step_rad) : sweep.first_rad;
  scan.time_step_s = upside_down ? -sweep.step_s : sweep.step_s;
  scan.first_beam_s = -0.5 * gaps * scan.time_step_s;
  scan.ranges_m = std::move(sweep.ranges_m);
  if (upside_down) std::ranges::reverse(scan.ranges_m);
}

}  // namespace topogeo::devices
