// A file with the alarms, which outlives a killed service: a JSON line for each change of an alarm.
// The last line of a number counts. Now and then the file is replaced by one of only these lines,
// so that its size has a limit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>

#include "channels/alarm.hpp"

namespace topogeo::web {

using Alarms = std::map<std::uint64_t, Alarm>;  ///< by number

class AlarmFile {
 public:
  /// The file is replaced when it has so many lines for each alarm that is kept.
  static constexpr std::size_t kLinesPerAlarm = 4;

  /// At most `most` alarms are kept. Empty: no file.
  AlarmFile(std::filesystem::path file, std::size_t most);

  /// Reads the alarms, the newest `most` of them; lines that are cut or damaged count as none.
  /// Throws std::runtime_error with the file if it cannot be read or written, or has other content.
  [[nodiscard]] Alarms open();
  /// Writes a change of one of `alarms`; without an alarm of that number it was removed. False when
  /// it could not be written.
  [[nodiscard]] bool keep(std::uint64_t number, const Alarms& alarms);

 private:
  /// Throws std::runtime_error with the file.
  void replace(const Alarms& alarms);

  std::filesystem::path file_;
  std::size_t most_;
  std::ofstream out_;
  std::size_t lines_ = 0;
};

}  // namespace topogeo::web
