#include "laser_memory.hpp"

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

namespace topogeo::sensor_gateway {

using devices::LineSettings;
using devices::Parity;

namespace {

struct NamedParity {
  std::string_view name;
  Parity parity;
};
constexpr std::array<NamedParity, 3> kParities{
    {{"none", Parity::kNone}, {"even", Parity::kEven}, {"odd", Parity::kOdd}}};
/// Rates of a SICK laser.
constexpr std::array<std::uint32_t, 4> kBauds{9600, 19200, 38400, 500'000};

std::string text_of(const LineSettings& line) {
  for (const NamedParity& named : kParities) {
    if (named.parity != line.parity) continue;
    return std::to_string(line.baud) + " " + std::string(named.name) + "\n";
  }
  return {};
}

}  // namespace

std::optional<LineSettings> LaserMemory::load() const {
  if (path_.empty()) return std::nullopt;
  std::ifstream file(path_, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  for (const std::uint32_t baud : kBauds) {
    for (const NamedParity& named : kParities) {
      const LineSettings line{baud, named.parity};
      if (text == text_of(line)) return line;
    }
  }
  return std::nullopt;
}

void LaserMemory::store(const LineSettings& line) {
  if (path_.empty() || stored_ == line) return;
  stored_ = line;
  // Not forced to disk, which would block the gateway; a partial file counts as empty.
  std::ofstream(path_, std::ios::binary) << text_of(line);
}

}  // namespace topogeo::sensor_gateway
