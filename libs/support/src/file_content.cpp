#include "topogeo/support/file_content.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace topogeo::support {

std::string file_content(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw std::runtime_error(path.string() + ": is a directory, expected a file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(path.string() +
                             ": cannot be opened: " + std::generic_category().message(errno));
  }
  std::string content(std::istreambuf_iterator<char>(file), {});
  if (file.bad()) throw std::runtime_error(path.string() + ": cannot be read");
  return content;
}

}  // namespace topogeo::support
