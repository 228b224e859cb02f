#include "topogeo/exchange/read_text.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace topogeo::exchange {

std::string read_text(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMostBytes = 2'000'000'000;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw std::runtime_error(path.string() + ": cannot be read: it is a directory");
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + ": cannot be opened: " + std::strerror(errno));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kMostBytes) {
    throw std::runtime_error(path.string() + ": is " + std::to_string(size) +
                             " bytes, expected at most 2 GB");
  }
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw std::runtime_error(path.string() + ": cannot be read");
  return text;
}

}  // namespace topogeo::exchange
