#include "writer_robots.hpp"

#include <algorithm>
#include <mutex>

#include "robot_partitions.hpp"

namespace topogeo::messaging {

void WriterRobots::allow(const Handle& writer, const std::vector<std::string>& partitions) {
  Robots robots;
  for (const std::string& name : partitions) robots.emplace_back(robot_of_partition(name));
  if (partitions.empty()) robots.emplace_back(kEveryRobot);  // permissions without a limit
  const ParticipantPrefix participant = prefix_of(writer);
  const std::lock_guard lock(mutex_);
  std::erase(departed_, participant);
  writers_[participant][writer] = std::move(robots);
}

bool WriterRobots::allows(const Handle& writer, std::string_view robot) const {
  const std::shared_lock lock(mutex_);
  const auto participant = writers_.find(prefix_of(writer));
  if (participant == writers_.end()) return false;
  const auto found = participant->second.find(writer);
  return found != participant->second.end() &&
         std::ranges::any_of(found->second, [&](const std::string& allowed) {
           return allowed == robot || allowed == kEveryRobot;
         });
}

void WriterRobots::depart(const Handle& participant) {
  const ParticipantPrefix prefix = prefix_of(participant);
  const std::lock_guard lock(mutex_);
  if (!writers_.contains(prefix) || std::ranges::find(departed_, prefix) != departed_.end()) return;
  departed_.push_back(prefix);
  if (departed_.size() <= kMostDeparted) return;
  writers_.erase(departed_.front());
  departed_.pop_front();
}

WriterRobots& writer_robots() {
  // Never destroyed: the threads of the middleware may outlive static objects.
  static auto* const robots = new WriterRobots;  // NOLINT(cppcoreguidelines-owning-memory)
  return *robots;
}

}  // namespace topogeo::messaging
