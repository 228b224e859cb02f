#include "new_arrival.hpp"

namespace topogeo::navigator {

bool is_new_arrival(const navigation::NavigatorStatus& status,
                    const std::optional<navigation::NavigatorStatus>& before) {
  const bool there_before =
      before && before->state == status.state && before->goal_id == status.goal_id;
  return status.state == navigation::NavigatorState::kArrived && !there_before;
}

}  // namespace topogeo::navigator
