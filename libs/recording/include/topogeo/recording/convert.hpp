// Converts between logs: CARMEN, .db3, .mcap, .bag, in any combination.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "topogeo/recording/survey.hpp"

namespace topogeo::recording {

struct ConvertOptions {
  TopicChoice topics;  ///< of a recording that is converted to a CARMEN log
  std::string compression =
      "zstd";  ///< of .mcap: none, lz4, zstd; of .bag: none, lz4, bz2 (zstd: none)
};

struct Conversion {
  std::uint64_t scans = 0;
  std::uint64_t odometry = 0;
  std::uint64_t transforms = 0;  ///< their messages
  /// Count by topic of messages that have other types or cannot be read.
  std::map<std::string, std::uint64_t> left_out;
  std::vector<std::string> notes;  ///< for people: damage, choices made
};

/// A conversion between recordings copies all laser scans, odometry and transforms with their
/// topics and times and leaves out other messages. A CARMEN log has the scans of one topic with the
/// odometry at their times. Throws std::runtime_error naming the file that cannot be read or
/// written, std::invalid_argument for an unknown compression.
Conversion convert(const std::filesystem::path& in, const std::filesystem::path& out,
                   const ConvertOptions& options = {});

}  // namespace topogeo::recording
