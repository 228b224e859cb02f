#include "topogeo/storage/relations.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "topogeo/support/file_content.hpp"
#include "topogeo/support/format.hpp"

#include "text_fields.hpp"

namespace topogeo::storage {
namespace {

constexpr double kLargestAngle_rad = 1e4;  // a larger number is damaged

Relation parse_relation(std::string_view line, const std::string& where) {
  static constexpr std::array<const char*, 6> kNames{"x", "y", "z", "roll", "pitch", "yaw"};
  Relation relation;
  relation.stamp_a_ns = take_stamp(line, where, "t1");
  relation.stamp_b_ns = take_stamp(line, where, "t2");
  std::array<double, 6> values{};
  take_numbers(line, where, kNames, "t1 t2 x y z roll pitch yaw", values);
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
    relations.push_back(parse_relation(line, where));
  });
  return relations;
}

std::vector<Relation> read_relations(const std::filesystem::path& path) {
  return parse_relations(support::file_content(path), path.string());
}

}  // namespace topogeo::storage
