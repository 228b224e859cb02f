// Files read whole and the YAML in them, with messages that name file, line and field.
#pragma once

#include <filesystem>
#include <string>

#include <yaml-cpp/yaml.h>

namespace topogeo::planning {

/// Throws std::runtime_error naming the file when it cannot be read or is over 1 GB.
std::string read_text_file(const std::filesystem::path& path);

/// Throws std::runtime_error "SOURCE:LINE: ..." for text that is not YAML.
YAML::Node parse_yaml(const std::string& text, const std::string& source);

/// Throws std::runtime_error "SOURCE:LINE: FIELD: expected EXPECTED, got ...".
[[noreturn]] void fail_in_yaml(const std::string& source, const YAML::Node& at,
                               const std::string& field, const std::string& expected);

/// A number in [low, high]; fails as above otherwise.
double number_in_yaml(const std::string& source, const YAML::Node& node, const std::string& field,
                      double low, double high, const std::string& unit);

}  // namespace topogeo::planning
