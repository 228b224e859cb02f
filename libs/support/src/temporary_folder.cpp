#include "topogeo/support/temporary_folder.hpp"

#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is not in cstdlib

namespace topogeo::support {

TemporaryFolder::TemporaryFolder(const std::string& name) {
  std::string made =
      (std::filesystem::temp_directory_path() / ("topogeo-" + name + "-XXXXXX")).string();
  if (::mkdtemp(made.data()) == nullptr) {
    throw std::runtime_error(made + ": " + std::generic_category().message(errno));
  }
  path_ = made;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace topogeo::support
