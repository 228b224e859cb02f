#include <optional>
#include <stdexcept>
#include <string>

#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/hash.hpp"

#include "checks.hpp"

namespace topogeo::fuzz {
namespace {

std::optional<storage::MapDocument> read(std::string_view bytes) {
  try {
    return storage::parse_map_file(bytes, "input");
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

/// A file with the fields of `body` between its header (format and version) and its checksum.
std::string sealed(std::string_view body) {
  std::string bytes("\x0a\x0btopogeo-map\x10\x01");
  bytes += body;
  const std::uint64_t checksum = support::fnv1a(bytes);
  bytes += '\x79';
  for (unsigned shift = 0; shift < 64; shift += 8) {
    bytes += static_cast<char>((checksum >> shift) & 0xffU);
  }
  return bytes;
}

/// True if the bytes can be read.
bool check(std::string_view bytes) {
  const auto document = read(bytes);
  if (!document) return false;
  const std::string written = storage::map_file_bytes(*document);
  const auto again = read(written);
  require(again.has_value(), "a map that was read can be written and read");
  require(storage::map_file_bytes(*again) == written, "writing what was read changes nothing");
  return true;
}

}  // namespace

std::size_t check_map_file(std::string_view bytes) {
  return (check(bytes) ? 1U : 0U) + (check(sealed(bytes)) ? 1U : 0U);
}

}  // namespace topogeo::fuzz
