// Robots that the writers of peers may write for, by the signed permissions.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/messaging/same_participant.hpp"

namespace topogeo::messaging {

/// Thread-safe.
class WriterRobots {
 public:
  /// Number of departed peers kept, because their messages may still wait to be handled.
  static constexpr std::size_t kMostDeparted = 4096;

  /// The permissions of its participant allow the writer these partitions (partitions_by_robot()).
  /// Replaces earlier ones.
  void allow(const Handle& writer, const std::vector<std::string>& partitions);

  /// Whether the writer may write for the robot. False for a writer without permissions.
  [[nodiscard]] bool allows(const Handle& writer, std::string_view robot) const;

  /// The participant with this id has left. After kMostDeparted others its writers are forgotten,
  /// unless it has come back.
  void depart(const Handle& participant);

 private:
  using Robots = std::vector<std::string>;

  mutable std::shared_mutex mutex_;
  std::map<ParticipantPrefix, std::map<Handle, Robots>> writers_;  // by participant
  std::deque<ParticipantPrefix> departed_;
};

/// The table of this process. fast_dds/writer_permissions.cpp fills it.
WriterRobots& writer_robots();

}  // namespace topogeo::messaging
