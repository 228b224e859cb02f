// Writes localization.csv for a drive of any length in a finished map.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>

#include "topogeo/relocalization/map_tracker.hpp"

namespace topogeo::localizer {

class StopTable {
 public:
  /// The stops of the drive that are still known, and the number of all its stops.
  struct Stops {
    std::span<const localization::LocalizedStop> known;
    std::size_t added = 0;
  };

  /// Rows go to FILE.part until the end. Throws std::runtime_error when it cannot be written.
  explicit StopTable(std::filesystem::path file);

  /// Writes the stops since the last call, except the last one, whose pose may still be set. Errors
  /// are reported by finish(), because a table must not stop a robot.
  void add(Stops stops);
  /// Writes the last stop, too, and gives the file its name. Throws std::runtime_error when not all
  /// rows could be written.
  void finish(Stops stops);

 private:
  /// Writes the stops before number `end`.
  void write(Stops stops, std::size_t end);
  void check() const;

  std::filesystem::path file_;
  std::filesystem::path part_;
  std::ofstream out_;
  std::size_t written_ = 0;
};

}  // namespace topogeo::localizer
