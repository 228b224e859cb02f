#include "topogeo/service/runtime_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>

#include <unistd.h>

#include "topogeo/support/log.hpp"

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

std::filesystem::path own_runtime_file(const Setup& setup, std::string_view ending,
                                       std::string_view loss) {
  std::string of_user = "." + std::to_string(::geteuid());
  of_user += ending;
  std::filesystem::path file = runtime_file(setup, of_user);
  if (::access(file.parent_path().c_str(), W_OK) == 0) return file;
  spdlog::warn("{}: cannot be written, so {}", file.parent_path().string(), loss);
  return {};
}

}  // namespace topogeo::service
