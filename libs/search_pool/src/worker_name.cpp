#include "topogeo/search_pool/worker_name.hpp"

#include <algorithm>
#include <cstdint>
#include <random>
#include <stdexcept>

#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"

namespace topogeo::search_pool {

namespace {

// Quotes and percent signs would need escapes in scripts, '#' ends the name in an id.
bool is_allowed(char c) {
  const auto code = static_cast<unsigned char>(c);
  return code > ' ' && code != 0x7F && c != '\'' && c != '"' && c != '%' && c != '#';
}

}  // namespace

std::string default_name() {
  std::string name = support::host_name();
  name.resize(std::min(name.size(), kLongestName));
  // A host's name is ASCII by rule; other characters could be cut in the middle.
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return !is_allowed(c) || static_cast<unsigned char>(c) >= 0x80; }, '-');
  return name;
}

std::string check_name(const std::string& name) {
  if (name.empty() || name.size() > kLongestName ||
      !std::all_of(name.begin(), name.end(), is_allowed)) {
    return fmt::format(
        "worker name '{}': expected 1 to {} bytes without blanks, quotes, '%' and '#'", name,
        kLongestName);
  }
  return {};
}

std::string make_worker_id(const std::string& name) {
  if (const std::string complaint = check_name(name); !complaint.empty()) {
    throw std::invalid_argument(complaint);
  }
  std::random_device device;
  const std::uint64_t number = (std::uint64_t{device()} << 32U) | device();
  return fmt::format("{}#{:016x}", name, number);
}

}  // namespace topogeo::search_pool
