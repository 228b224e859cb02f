#include "topogeo/exchange/read_text.hpp"

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::exchange {

std::string read_text(const std::filesystem::path& path) {
  return support::foreign_content(path, support::kMostTextBytes);
}

std::string read_map_bytes(const std::filesystem::path& path) {
  return support::foreign_content(path, support::kMostMapBytes);
}

}  // namespace topogeo::exchange
