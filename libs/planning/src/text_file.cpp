#include "text_file.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>

namespace topogeo::planning {
namespace {

/// Far more than the largest grid's picture (20,000 x 20,000 pixels) takes; protects the memory.
constexpr std::uintmax_t kMostBytes = 1U << 30U;

}  // namespace

std::string read_text_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw std::runtime_error(path.string() + ": " + error.message());
  if (size > kMostBytes) {
    throw std::runtime_error(path.string() + ": has " + std::to_string(size) +
                             " bytes, allowed are " + std::to_string(kMostBytes));
  }
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.good() && !in.eof()) {
    throw std::runtime_error(path.string() + ": " +
                             std::error_code(errno, std::generic_category()).message());
  }
  return text;
}

}  // namespace topogeo::planning
