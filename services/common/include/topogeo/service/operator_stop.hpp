// Stores an operator's stop for a base that does not report stops, so that the stop survives
// restarts of the program.
//
// A base that reports its state (BaseStatus) holds itself and decides about its release. Any other
// base, for example one of ROS, obeys each motion command, so the programs that command it keep the
// stop: the web service and the navigator.
//
// Each stop has a number, which its release names (BaseCommand::stop_count). A release that a cut
// link delivers late therefore ends no later stop, and a stop that is repeated for a program that
// starts again undoes no release.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/record_file.hpp"

namespace topogeo::service {

class OperatorStop {
 public:
  /// The number of a new stop; never 0.
  static std::uint64_t new_number();
  /// File of a service that was given none, see own_runtime_file().
  static std::filesystem::path place_of(const Setup& setup);

  /// Resumes the stop that the file records; a damaged file counts as a stop. With an empty path,
  /// nothing is stored. Throws std::runtime_error naming the file if it cannot be opened or
  /// created.
  explicit OperatorStop(const std::filesystem::path& file);

  /// The operator of this program stops the robot.
  void hold(std::uint64_t number);
  /// The operator of this program releases the robot.
  void release();
  /// The base reports that it is held: it decides about the release from now on.
  void hand_over();
  /// The number in the newest status of the base (BaseStatus::stop_count). A reset that names it
  /// means the stop that holds here as well: a base that is offline reports no stop.
  void base_counts(std::uint64_t stop_count) { base_count_ = stop_count; }
  /// Takes the order of another program. The newest halt replaces an earlier one, so its release
  /// ends both, which a gateway permits only if the sender knows them. Returns whether it began or
  /// ended a stop.
  bool take(const msg::BaseCommand& command, const messaging::Handle& writer);

  /// Age, at the start of the program, of the stop in the file; empty without a stop, or if the
  /// file system has no time of it.
  [[nodiscard]] std::optional<std::chrono::seconds> age_at_start() const { return age_at_start_; }
  [[nodiscard]] bool holds() const { return record_.held != 0; }
  /// The stop in force, or the last one that was released; 0 without any.
  [[nodiscard]] std::uint64_t number() const { return holds() ? record_.number : record_.released; }

 private:
  struct Record {
    std::uint64_t number = 0;    // of the stop that holds
    std::uint64_t released = 0;  // the last one that was released
    std::uint64_t held = 0;
    bool operator==(const Record&) const = default;
  };

  void keep(const Record& record);
  void store();

  std::filesystem::path path_;
  support::RecordFile<Record> file_;
  std::optional<std::chrono::seconds> age_at_start_;
  Record record_;
  bool stored_ = true;                          // record_ is in the file
  std::uint64_t base_count_ = 0;                // 0: no base has reported any
  std::optional<messaging::Handle> halted_by_;  // the writer of the stop that holds, if another's
};

/// The age of a stop for people: "12 min ago"; empty without an age.
std::string age_in_words(const std::optional<std::chrono::seconds>& age);

}  // namespace topogeo::service
