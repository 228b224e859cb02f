#include "topogeo/storage/relations.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "file_content.hpp"
#include "text_fields.hpp"

namespace topogeo::storage {
namespace {

constexpr double kLargestAngle_rad = 1e4;

std::int64_t stamp_or_throw(std::string_view& line, const std::string& where, const char* name) {
  const std::string_view word = next_word(line);
  const auto stamp_ns = parse_stamp(word);
  if (stamp_ns) return *stamp_ns;
  throw std::runtime_error(
      fmt::format("{}: {} '{}': expected seconds such as 12.345678", where, name, word));
}

Relation parse_line(std::string_view line, const std::string& where) {
  static constexpr std::array<const char*, 6> kNames{"x", "y", "z", "roll", "pitch", "yaw"};
  Relation relation;
  relation.stamp_a_ns = stamp_or_throw(line, where, "t1");
  relation.stamp_b_ns = stamp_or_throw(line, where, "t2");
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string_view word = next_word(line);
    const auto value = parse_number(word);
    if (!value) {
      throw std::runtime_error(
          fmt::format("{}: {} '{}': expected a number, 8 on a line", where, kNames.at(i), word));
    }
    values.at(i) = *value;
  }
  if (!next_word(line).empty()) {
    throw std::runtime_error(where + ": more than the 8 numbers t1 t2 x y z roll pitch yaw");
  }
  if (std::fabs(values[5]) > kLargestAngle_rad) {
    throw std::runtime_error(fmt::format("{}: yaw {}: expected radians, at most {} of them", where,
                                         values[5], kLargestAngle_rad));
  }
  relation.T_a_b = {values[0], values[1], geometry::wrap_angle(values[5])};
  return relation;
}

}  // namespace

std::vector<Relation> parse_relations(std::string_view text, const std::string& name) {
  std::vector<Relation> relations;
  for_each_line(text, name, [&](std::string_view line, const std::string& where) {
    relations.push_back(parse_line(line, where));
  });
  return relations;
}

std::vector<Relation> read_relations(const std::filesystem::path& path) {
  return parse_relations(file_content(path), path.string());
}

}  // namespace topogeo::storage
