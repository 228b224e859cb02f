// The coordinate system of a GeoJSON file, and its positions in metres.
//
// RFC 7946 has longitude and latitude in degrees; Nav2 writes metres of its map; programs for
// geodata write metres of a national grid, thousands of kilometres from its origin.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "topogeo/exchange/output_file.hpp"

#include "json_reader.hpp"

namespace topogeo::exchange {

class GeojsonFrame {
 public:
  /// Finds the system by the member `crs`, else by the coordinates: degrees if all of them can be
  /// and the whole file would be smaller than 5 cm in metres. Throws std::runtime_error naming the
  /// coordinate that is no number.
  explicit GeojsonFrame(const JsonValue& top);

  /// A position [x, y] of the file in the map frame, metres.
  [[nodiscard]] Eigen::Vector2d position_m(const JsonValue& value) const;

  /// Notes on how the coordinates were changed.
  [[nodiscard]] const Notes& notes() const { return notes_; }

 private:
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> to_map_;
  Notes notes_;
};

}  // namespace topogeo::exchange
