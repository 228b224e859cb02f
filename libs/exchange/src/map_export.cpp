#include "topogeo/exchange/map_export.hpp"

namespace topogeo::exchange {

ExportedMap export_map(const storage::MapDocument& map, std::string_view format,
                       const std::filesystem::path& path, const ExportSettings& settings) {
  return format_named(export_formats(), format).write(map, path, settings);
}

}  // namespace topogeo::exchange
