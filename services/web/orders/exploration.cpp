#include "orders/exploration.hpp"

#include "topogeo/support/format.hpp"

namespace topogeo::web {

void Exploration::start(const navigation::TourConfig& config) {
  tour_ = std::make_unique<navigation::ExplorationTour>(config);
  goal_id_ = 0;
  time_ = {};
}

std::optional<ExplorationGoal> Exploration::step(const ExploredFloor& floor,
                                                 navigation::NavigatorStatus navigator, bool taken,
                                                 std::chrono::nanoseconds period) {
  if (!tour_) return std::nullopt;
  using navigation::HaltReason;
  if (taken && navigator.reason == HaltReason::kPaused) return std::nullopt;
  time_ += period;
  tour_->follow(floor.graph, floor.map, floor.T_map_stops);
  navigator.goal_id = taken ? goal_id_ : 0;
  const auto goal = tour_->step(navigator, time_.count());
  if (!goal) return std::nullopt;
  goal_id_ = goal->goal_id;
  return ExplorationGoal{goal->T_map_goal,
                         fmt::format("what is not mapped yet ({})", tour_->message())};
}

std::string Exploration::summary() const {
  if (!tour_) return {};
  return fmt::format("{} targets, {} of them given up; {}", tour_->targets(), tour_->given_up(),
                     tour_->message());
}

}  // namespace topogeo::web
