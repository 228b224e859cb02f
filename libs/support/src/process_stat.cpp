#include "topogeo/support/process_stat.hpp"

#include <fstream>
#include <iterator>
#include <string>

namespace topogeo::support {

std::istringstream process_stat(const std::filesystem::path& process) {
  std::ifstream file(process / "stat", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t name_end = text.rfind(')');  // a name may contain brackets and line ends
  return std::istringstream(name_end == std::string::npos ? "" : text.substr(name_end + 1));
}

}  // namespace topogeo::support
