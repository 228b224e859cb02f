// localization.csv of a drive in a finished map, however long it is.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>

#include "topogeo/localization/tracking/map_localizer.hpp"

namespace topogeo::localizer {

class StopTable {
 public:
  /// Those of the drive that are still known, and how many there were in all.
  struct Stops {
    std::span<const localization::LocalizedStop> known;
    std::size_t added = 0;
  };

  /// What comes before the end is in FILE.part. Throws std::runtime_error when it cannot be
  /// written.
  explicit StopTable(std::filesystem::path file);

  /// Writes the stops since the last call, but not the last one, whose pose may still be set. That
  /// this fails is said at the end: no robot is to be left alone for a table.
  void add(Stops stops);
  /// The last one too; the file has its name from now on. Throws std::runtime_error when not all
  /// could be written.
  void finish(Stops stops);

 private:
  /// Those before number `end`.
  void write(Stops stops, std::size_t end);
  void check() const;

  std::filesystem::path file_;
  std::filesystem::path part_;
  std::ofstream out_;
  std::size_t written_ = 0;
};

}  // namespace topogeo::localizer
