#include "topogeo/support/file_content.hpp"

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::support {

std::string file_content(const std::filesystem::path& path) {
  return foreign_content(path, kMostMapBytes);
}

}  // namespace topogeo::support
