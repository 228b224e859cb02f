#include "deaf_lives.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <system_error>

namespace topogeo::service {
namespace {

/// Number of runs after which the waits stop growing.
constexpr std::uint32_t kMostLives = 9;

/// Makes a file name: no folders in it.
std::string without_slashes(std::string text) {
  std::ranges::replace(text, '/', '_');
  return text;
}

}  // namespace

std::filesystem::path DeafLives::place_of(const Setup& setup) {
  const char* given = std::getenv("RUNTIME_DIRECTORY");  // NOLINT(concurrency-mt-unsafe): not set
  std::string folder = given == nullptr ? "" : given;
  folder = folder.substr(0, folder.find(':'));
  if (folder.empty()) folder = "/dev/shm";
  const ServiceOptions& options = setup.options;
  return std::filesystem::path(folder) /
         ("topogeo-" + without_slashes(options.partition) + "." + std::to_string(options.domain) +
          "-" + without_slashes(options.robot_id) + "-" + setup.name + ".deaf");
}

std::uint32_t DeafLives::load() const {
  std::ifstream file(file_, std::ios::binary);
  std::uint32_t lives = 0;
  return file >> lives && lives <= kMostLives ? lives : 0;
}

void DeafLives::store(std::uint32_t lives) const {
  if (lives == 0) {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
    return;
  }
  std::ofstream(file_, std::ios::binary) << std::min(lives, kMostLives) << '\n';
}

}  // namespace topogeo::service
