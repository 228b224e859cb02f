// Writes one map in one format: a method for each row of map_formats.cpp.
#pragma once

#include <filesystem>
#include <string>

#include "topogeo/exchange/export_header.hpp"
#include "topogeo/exchange/map_export.hpp"
#include "topogeo/exchange/output_file.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// The map, and its derived data, made when a format needs them. Call one method for a format, then
/// take(). They throw like export_map().
class MapWriter {
 public:
  MapWriter(const storage::MapDocument& map, const std::filesystem::path& path,
            const ExportSettings& settings);

  void grid();
  void masks();
  void geojson();
  void lif();
  void zones();
  void rmf();
  void graphml();
  void g2o();
  void svg();
  void png();
  void tum();
  void carmen();
  void pb();

  ExportedMap take() { return std::move(out_); }

 private:
  [[nodiscard]] planning::HybridMap hybrid_map() const;
  RouteNetwork network();
  void put(std::string bytes);
  void note(const Notes& notes);

  const storage::MapDocument& map_;
  std::filesystem::path path_;
  const ExportSettings& settings_;
  NetworkSettings network_ = settings_.network;
  ExportHeader header_ = settings_.header;
  ExportedMap out_;
};

}  // namespace topogeo::exchange
