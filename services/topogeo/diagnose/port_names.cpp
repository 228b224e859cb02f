#include "diagnose/port_names.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

namespace topogeo::cli {

namespace fs = std::filesystem;

std::vector<fs::path> serial_ports(const fs::path& dev) {
  constexpr std::array<std::string_view, 3> kKinds{"ttyUSB", "ttyACM", "ttyAMA"};
  std::vector<fs::path> ports;
  std::error_code error;
  for (fs::directory_iterator entry(dev, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (std::ranges::any_of(kKinds, [&](auto kind) { return name.starts_with(kind); })) {
      ports.push_back(entry->path());
    }
  }
  std::ranges::sort(ports);
  return ports;
}

fs::path lasting_name(const fs::path& port, const fs::path& dev) {
  std::error_code error;
  const fs::path wanted = fs::canonical(port, error);
  if (error) return port;
  const fs::path whole = fs::absolute(port, error);
  std::vector<fs::path> names;
  for (fs::directory_iterator entry(dev / "serial" / "by-id", error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    if (fs::canonical(entry->path(), gone) == wanted && !gone) names.push_back(entry->path());
  }
  return names.empty() ? whole : *std::ranges::min_element(names);
}

}  // namespace topogeo::cli
