// Partitions by robot: with security a reader and a writer meet only if the permissions of both
// name a common robot. The access control plug-in checks the partitions of local and remote readers
// and writers against the signed permissions (Object Management Group, DDS Security 1.1, chapter
// 9.4.1.3.2.3).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::messaging {

/// Robot of keys that are for all robots.
inline constexpr std::string_view kEveryRobot = "*";

/// The robots of the keys in a folder of deploy/security/make_keys, from its file `robots`:
/// kEveryRobot alone for `all` and, with a warning, for older keys, which have no such file. The
/// signed permissions decide; the file only selects the partitions to ask for. Throws
/// std::runtime_error when it cannot be read or has no robot.
std::vector<std::string> robots_of_keys(const std::filesystem::path& folder);

/// The partitions of a participant of `partition` with keys for `key_robots`: "PARTITION/ROBOT" for
/// each. Keys for every robot add the plain partition, for programs that do not use partitions by
/// robot, and one for each of `robots`, so that the participant meets readers and writers of these
/// robots. Throws std::runtime_error when the keys do not name one of `robots`.
std::vector<std::string> partitions_by_robot(const std::string& partition,
                                             const std::vector<std::string>& key_robots,
                                             const std::vector<std::string>& robots);

/// The robot of such a partition; kEveryRobot if it names none.
std::string_view robot_of_partition(std::string_view name);

/// The partition name without its robot.
std::string_view partition_without_robot(std::string_view name);

}  // namespace topogeo::messaging
