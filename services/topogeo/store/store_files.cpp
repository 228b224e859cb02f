#include "store/store_files.hpp"

#include <exception>
#include <string_view>

#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/foreign_file.hpp"

namespace topogeo::cli {

namespace {

constexpr std::string_view kDatabaseStart = "SQLite format 3";
// A Protobuf text field of eleven bytes, followed by its text.
constexpr std::string_view kMapFileStart = "\x0a\x0btopogeo-map";

std::string start_of(const std::filesystem::path& file) {
  constexpr std::size_t kStart = 16;
  return support::first_bytes(file, kStart);
}

}  // namespace

storage::MapDocument read_any_map(const std::filesystem::path& file) {
  try {
    return storage::read_map(file);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

bool looks_like_map(const std::filesystem::path& file) {
  const std::string start = start_of(file);
  return start.starts_with(kDatabaseStart) || start.starts_with(kMapFileStart);
}

bool looks_like_database(const std::filesystem::path& file) {
  return start_of(file).starts_with(kDatabaseStart);
}

}  // namespace topogeo::cli
