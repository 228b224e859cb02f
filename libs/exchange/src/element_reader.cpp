#include "element_reader.hpp"

#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/hash.hpp"

#include "map_fields.hpp"
#include "wire.hpp"

namespace topogeo::exchange {

storage::MapDocument read_alone(const std::string& robot_id, const std::string& fields) {
  std::string bytes = bytes_field(MapFields::kFormat, "topogeo-map") +
                      varint_field(MapFields::kVersion, storage::kMapFormatVersion) +
                      bytes_field(MapFields::kRobot, robot_id) + fields;
  bytes += fixed64_field(MapFields::kChecksum, support::fnv1a(bytes));
  return storage::parse_map_file(bytes, "element");
}

}  // namespace topogeo::exchange
