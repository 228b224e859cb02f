#include "stop_comparisons.hpp"

#include <cmath>

namespace topogeo::localization {

namespace {

// A smaller change of the prediction leaves the search space nearly the same.
constexpr double kPredictionMoved_m = 0.3;
constexpr double kPredictionMoved_rad = 0.05;

}  // namespace

bool StopComparisons::worth(std::uint32_t earlier, std::uint32_t later,
                            const geometry::Pose2& T_later_earlier) const {
  if (later >= of_later_.size()) return true;
  const auto found = of_later_[later].find(earlier);
  if (found == of_later_[later].end()) return true;
  if (found->second.accepted) return false;
  const geometry::Pose2& before = found->second.T_later_earlier;
  return (before.position_m() - T_later_earlier.position_m()).squaredNorm() >
             kPredictionMoved_m * kPredictionMoved_m ||
         std::fabs(geometry::wrap_angle(before.theta_rad - T_later_earlier.theta_rad)) >
             kPredictionMoved_rad;
}

void StopComparisons::record(std::uint32_t earlier, std::uint32_t later,
                             const geometry::Pose2& T_later_earlier, bool accepted) {
  if (later >= of_later_.size()) of_later_.resize(later + 1);
  of_later_[later][earlier] = {T_later_earlier, accepted};
}

void StopComparisons::forget(std::uint32_t earlier, std::uint32_t later) {
  if (later < of_later_.size()) of_later_[later].erase(earlier);
}

}  // namespace topogeo::localization
