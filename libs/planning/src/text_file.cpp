#include "text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace topogeo::planning {
namespace {

constexpr std::uintmax_t kMostBytes =
    1U << 30U;  // a larger file is no drawing, and would fill the memory

std::string shown(const YAML::Node& node) {
  constexpr std::size_t kMostShown = 40;
  if (!node.IsDefined() || node.IsNull()) return "nothing";
  if (node.IsSequence()) return "a list of " + std::to_string(node.size());
  if (node.IsMap()) return "a map";
  std::string text = node.Scalar().substr(0, kMostShown);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, '?');
  return "'" + text + "'";
}

}  // namespace

std::string read_text_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw std::runtime_error(path.string() + ": " + error.message());
  if (size > kMostBytes) {
    throw std::runtime_error(path.string() + ": has " + std::to_string(size) +
                             " bytes, allowed are " + std::to_string(kMostBytes));
  }
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.good() && !in.eof()) {
    throw std::runtime_error(path.string() + ": " +
                             std::error_code(errno, std::generic_category()).message());
  }
  return text;
}

YAML::Node parse_yaml(const std::string& text, const std::string& source) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const int line = std::max(error.mark.line + 1, 1);
    throw std::runtime_error(source + ":" + std::to_string(line) + ": " + error.msg);
  }
}

void fail_in_yaml(const std::string& source, const YAML::Node& at, const std::string& field,
                  const std::string& expected) {
  const int line = at.IsDefined() ? at.Mark().line + 1 : 1;
  throw std::runtime_error(source + ":" + std::to_string(std::max(line, 1)) + ": " + field +
                           ": expected " + expected + ", got " + shown(at));
}

double number_in_yaml(const std::string& source, const YAML::Node& node, const std::string& field,
                      double low, double high, const std::string& unit) {
  double value = 0.0;
  const bool is_number =
      node.IsDefined() && node.IsScalar() && YAML::convert<double>::decode(node, value);
  if (!is_number || !(value >= low && value <= high)) {
    std::ostringstream range;
    range << "a number from " << low << " to " << high;
    if (!unit.empty()) range << ' ' << unit;
    fail_in_yaml(source, node, field, range.str());
  }
  return value;
}

}  // namespace topogeo::planning
