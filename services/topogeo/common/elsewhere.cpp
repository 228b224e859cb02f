#include "common/elsewhere.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "topogeo/messaging/topics.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/printable.hpp"

namespace topogeo::cli {
namespace {

/// Robots by domain and partition.
using Settings = std::map<std::pair<std::uint32_t, std::string>, std::set<std::string>>;

bool is_seen_by(const DomainView& view, std::uint32_t domain, const std::string& partition) {
  return domain == view.domain &&
         (view.partition == messaging::kAnyPartition || view.partition == partition);
}

void add_settings(Settings& settings, std::uint32_t domain, const std::string& partition,
                  const std::string& robot) {
  std::set<std::string>& robots = settings[{domain, partition}];
  if (!robot.empty()) robots.insert(robot);
}

/// The robot in "robot/service", the name of a participant.
std::string robot_of_participant(const std::string& participant) {
  const std::size_t end = participant.rfind('/');
  return end == std::string::npos ? "" : participant.substr(0, end);
}

std::string text_of_settings(const Settings& settings) {
  std::string text;
  for (const auto& [where, robots] : settings) {
    const auto& [domain, partition] = where;
    std::string names;
    for (const std::string& robot : robots) {
      names += (names.empty() ? " (robot '" : ", '") + support::printable(robot) + "'";
    }
    text += fmt::format("{}domain {}, partition '{}'{}", text.empty() ? "" : "; ", domain,
                        support::printable(partition), names.empty() ? "" : names + ")");
  }
  return text;
}

}  // namespace

std::string services_elsewhere(const DomainView& view,
                               std::span<const messaging::RemoteEndpoint> discovered,
                               std::span<const HostProcess> processes) {
  Settings settings;
  for (const messaging::RemoteEndpoint& one : discovered) {
    if (!one.writer || one.topic != messaging::kServiceStatus) continue;
    for (const std::string& name : one.partitions) {
      const std::string partition = name.substr(0, name.rfind('/'));  // with security "name/robot"
      // Search workers are in all partitions and belong to no robot.
      if (partition == messaging::kAnyPartition || is_seen_by(view, view.domain, partition))
        continue;
      add_settings(settings, view.domain, partition, robot_of_participant(one.participant));
    }
  }
  for (const HostProcess& process : processes) {
    if (is_seen_by(view, process.domain, process.partition)) continue;
    if (process.partition == messaging::kAnyPartition && process.domain == view.domain) continue;
    add_settings(settings, process.domain, process.partition, process.robot);
  }
  return settings.empty() ? "" : "; services run on " + text_of_settings(settings);
}

}  // namespace topogeo::cli
