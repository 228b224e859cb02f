#include "topogeo/support/alike_lines.hpp"

#include <map>
#include <string_view>

#include "topogeo/support/format.hpp"

namespace topogeo::support {
namespace {

bool is_digit(char byte) {
  return byte >= '0' && byte <= '9';
}

/// The line without digits and without names between single quotes.
std::string shape_of(std::string_view line) {
  std::string shape;
  bool quoted = false;
  for (const char byte : line) {
    if (byte == '\'') quoted = !quoted;
    if (!quoted && !is_digit(byte)) shape += byte;
  }
  return shape;
}

}  // namespace

std::vector<std::string> merge_alike_lines(std::span<const std::string> lines) {
  struct Alike {
    std::size_t all = 0;
    std::size_t passed = 0;
  };
  std::map<std::string, Alike> groups;
  for (const std::string& line : lines) ++groups[shape_of(line)].all;
  std::vector<std::string> merged;
  for (const std::string& line : lines) {
    Alike& group = groups[shape_of(line)];
    if (group.all <= kMostAlikeLines) {
      merged.push_back(line);
    } else if (group.passed++ == 0) {
      merged.push_back(fmt::format("{} (and {} more like this)", line, group.all - 1));
    }
  }
  return merged;
}

}  // namespace topogeo::support
