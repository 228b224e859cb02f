#include "robot_partitions.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "topogeo/support/log.hpp"

namespace topogeo::messaging {

namespace {

constexpr std::string_view kAll = "all";
constexpr char kSeparator = '/';  // make_keys allows no robot with it in its name

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(text.empty() ? "'" : ", '").append(name + "'");
  return text;
}

}  // namespace

std::vector<std::string> robots_of_keys(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "robots";
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown) && !unknown) {
    spdlog::warn(
        "DDS security: the keys in '{}' name no robots and hold for every robot; renew them with "
        "make_keys and --robot",
        folder.string());
    return {std::string(kEveryRobot)};
  }
  std::ifstream file(path);
  std::vector<std::string> robots;
  for (std::string line; std::getline(file, line);) {
    if (line == kAll) return {std::string(kEveryRobot)};
    if (!line.empty()) robots.push_back(line);
  }
  if (robots.empty()) {
    throw std::runtime_error("cannot read the robots of the keys in '" + path.string() +
                             "', expected a name in each line, or 'all'");
  }
  return robots;
}

std::vector<std::string> partitions_by_robot(const std::string& partition,
                                             const std::vector<std::string>& key_robots,
                                             const std::vector<std::string>& robots) {
  const bool every = std::ranges::find(key_robots, kEveryRobot) != key_robots.end();
  std::vector<std::string> names;
  for (const std::string& robot : robots) {
    if (!every && std::ranges::find(key_robots, robot) == key_robots.end()) {
      throw std::runtime_error("the keys are for " + joined(key_robots) + ", not for '" + robot +
                               "'; renew them with make_keys and --robot");
    }
  }
  const auto add = [&](const std::string& robot) {
    std::string name = partition + kSeparator + robot;
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  };
  if (every) std::ranges::for_each(robots, add);
  std::ranges::for_each(key_robots, add);
  if (every) names.push_back(partition);
  return names;
}

std::string_view robot_of_partition(std::string_view name) {
  const std::size_t separator = name.rfind(kSeparator);
  return separator == std::string_view::npos ? kEveryRobot : name.substr(separator + 1);
}

std::string_view partition_without_robot(std::string_view name) {
  return name.substr(0, name.rfind(kSeparator));
}

}  // namespace topogeo::messaging
