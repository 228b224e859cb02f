#include "topogeo/exchange/read_text.hpp"

#include <cstdint>
#include <stdexcept>

#include "topogeo/support/file_content.hpp"

namespace topogeo::exchange {

std::string read_text(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMostBytes = 2'000'000'000;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kMostBytes) {
    throw std::runtime_error(path.string() + ": is " + std::to_string(size) +
                             " bytes, expected at most 2 GB");
  }
  return support::file_content(path);
}

}  // namespace topogeo::exchange
