// Tells an arrival from later changes of the status at the goal.
#pragma once

#include <optional>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigator {

/// Whether the robot has arrived at its goal since the status `before`; empty: there is none. It is
/// still at that goal when it is paused there or resumed.
[[nodiscard]] bool is_new_arrival(const navigation::NavigatorStatus& status,
                                  const std::optional<navigation::NavigatorStatus>& before);

}  // namespace topogeo::navigator
