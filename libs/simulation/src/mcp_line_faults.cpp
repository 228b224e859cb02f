#include "topogeo/simulation/mcp_line_faults.hpp"

#include <algorithm>

namespace topogeo::simulation {
namespace {

/// A truncated report keeps at least this many bytes, or a quarter of a short one, and loses at
/// least three times as many, so that no decoder can miss the loss.
constexpr std::size_t kLeastCut = 4;

}  // namespace

void McpLineFaults::damage(std::vector<std::uint8_t>& report) {
  if (corrupt_ > 0) {
    --corrupt_;
    report[random_.below(report.size())] ^= static_cast<std::uint8_t>(1U << random_.below(8));
  }
  if (truncate_ > 0) {
    --truncate_;
    const std::size_t least = std::min(kLeastCut, report.size() / 4);
    report.resize(least + random_.below(std::max<std::size_t>(report.size() - 4 * least, 1)));
  }
}

std::vector<std::uint8_t> McpLineFaults::garbage(std::size_t bytes) {
  std::vector<std::uint8_t> garbage(bytes);
  for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random_.below(256));
  return garbage;
}

}  // namespace topogeo::simulation
