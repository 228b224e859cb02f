#include "deaf_lives.hpp"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "topogeo/service/runtime_file.hpp"

namespace topogeo::service {
namespace {

/// Number of runs after which the waits stop growing.
constexpr std::uint32_t kMostLives = 9;

}  // namespace

std::filesystem::path DeafLives::place_of(const Setup& setup) {
  return runtime_file(setup, ".deaf");
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
