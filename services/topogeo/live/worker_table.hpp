// The last status of the search workers on a domain, as a table for people.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/status.h"

#include "common/text_grid.hpp"

namespace topogeo::cli {

/// State of a worker, or why a program of `version` and `matcher_fingerprint` does not use it.
/// `silence` is the time since its last status.
std::string worker_state(const msg::WorkerStatus& status, std::chrono::nanoseconds silence,
                         const std::string& version, std::uint64_t matcher_fingerprint);

/// Workers publish twice a second: one silent for this long hangs or is cut off.
inline constexpr std::chrono::milliseconds kWorkerSilent{1500};

class WorkerTable {
 public:
  using Clock = std::chrono::steady_clock;

  /// `version` and `matcher_fingerprint` of this program: workers with others are marked.
  WorkerTable(std::string version, std::uint64_t matcher_fingerprint)
      : version_(std::move(version)), matcher_fingerprint_(matcher_fingerprint) {}

  void update(const msg::WorkerStatus& status, const messaging::SampleInfo& info,
              Clock::time_point now);
  /// The worker has left, or was lost.
  void remove(const messaging::SampleInfo& info);
  /// Forgets workers that have been silent for kForget.
  void forget_silent(Clock::time_point now);

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// Head line, one line for each worker by name, no wider than `columns`, and a line with the
  /// totals. Columns with the same value everywhere are left out; a state that does not fit goes
  /// below. A worker silent for kSilent is marked.
  [[nodiscard]] std::string text(Clock::time_point now, std::size_t columns = kColumns) const;
  /// All fields, in a block of lines per worker.
  [[nodiscard]] std::string details(Clock::time_point now) const;
  /// The same for programs: an array of objects, field names as in the IDL.
  [[nodiscard]] std::string json(Clock::time_point now) const;

  static constexpr std::chrono::milliseconds kSilent = kWorkerSilent;
  static constexpr std::chrono::seconds kForget{10};

 private:
  struct Row {
    msg::WorkerStatus status;
    Clock::time_point received;
  };
  [[nodiscard]] std::string state(const Row& row, Clock::time_point now) const;
  [[nodiscard]] std::vector<std::string> lines(std::size_t longest_name) const;
  [[nodiscard]] std::string sums(Clock::time_point now) const;

  std::string version_;
  std::uint64_t matcher_fingerprint_;
  std::map<std::string, Row> rows_;  // by worker id
  std::map<messaging::Handle, std::string> ids_;
};

}  // namespace topogeo::cli
