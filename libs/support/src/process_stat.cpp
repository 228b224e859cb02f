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

}  // namespace topogeo::support
