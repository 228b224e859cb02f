#include "topogeo/support/process_stat.hpp"

#include <fstream>
#include <sstream>
#include <string>

namespace topogeo::support {

std::string process_file(const std::filesystem::path& file) {
  const std::ifstream input(file, std::ios::binary);
  // Reading fails if the process ends meanwhile. A stream notes that; an iterator would throw.
  std::ostringstream content;
  content << input.rdbuf();
  return content.str();
}

std::istringstream process_stat(const std::filesystem::path& process) {
  const std::string text = process_file(process / "stat");
  const std::size_t name_end = text.rfind(')');  // a name may contain brackets and line ends
  return std::istringstream(name_end == std::string::npos ? "" : text.substr(name_end + 1));
}

std::optional<std::uint64_t> process_start_ticks(const std::filesystem::path& process) {
  constexpr int kBeforeStart = 19;  // fields 3 to 21
  std::istringstream fields = process_stat(process);
  std::string skipped;
  for (int i = 0; i < kBeforeStart; ++i) fields >> skipped;
  std::uint64_t ticks = 0;
  if (!(fields >> ticks)) return std::nullopt;
  return ticks;
}

}  // namespace topogeo::support
