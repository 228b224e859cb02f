#include "topogeo/service/runtime_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

namespace topogeo::service {
namespace {

/// Makes a file name: no folders in it.
std::string without_slashes(std::string text) {
  std::ranges::replace(text, '/', '_');
  return text;
}

}  // namespace

std::filesystem::path runtime_file(const Setup& setup, std::string_view ending) {
  const char* given = std::getenv("RUNTIME_DIRECTORY");  // NOLINT(concurrency-mt-unsafe): not set
  std::string folder = given == nullptr ? "" : given;
  folder = folder.substr(0, folder.find(':'));
  if (folder.empty()) folder = "/dev/shm";
  const ServiceOptions& options = setup.options;
  std::string name = "topogeo-" + without_slashes(options.partition) + "." +
                     std::to_string(options.domain) + "-" + without_slashes(options.robot_id) +
                     "-" + setup.name;
  name += ending;
  return std::filesystem::path(folder) / name;
}

}  // namespace topogeo::service
