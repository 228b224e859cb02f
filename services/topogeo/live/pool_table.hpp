// The search pool as `topogeo top` shows it: workers, and the robots that they work for.
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

/// Space on a terminal.
struct TextSize {
  std::size_t columns = kColumns;
  std::size_t rows = 0;  ///< 0: any number
};

class PoolTable {
 public:
  using Clock = std::chrono::steady_clock;

  /// Time that a silent worker or robot stays in the table, for people who watch it.
  static constexpr std::chrono::seconds kForget{10};

  /// `version` and `matcher_fingerprint` of this program: workers with others are marked.
  PoolTable(std::string version, std::uint64_t matcher_fingerprint)
      : version_(std::move(version)), matcher_fingerprint_(matcher_fingerprint) {}

  void update(const msg::WorkerStatus& status, const messaging::SampleInfo& info,
              Clock::time_point now);
  void remove_worker(const messaging::SampleInfo& info);
  /// Adds a worker's faults and CPU state, or a localizer's tasks; other services are ignored.
  void update(const msg::ServiceStatus& status, const messaging::SampleInfo& info,
              Clock::time_point now);
  void remove_service(const messaging::SampleInfo& info);
  /// Forgets workers and robots that have been silent for kForget.
  void forget_silent(Clock::time_point now);

  [[nodiscard]] std::size_t workers() const { return workers_.size(); }

  /// A line with the totals, a line for each worker by name, a line for each robot. No wider than
  /// `size`; workers that do not fit in its rows are given as a number.
  [[nodiscard]] std::string text(Clock::time_point now, const TextSize& size = {}) const;
  /// {"workers": [...], "robots": [...], "total": {...}}; field names as in the IDL.
  [[nodiscard]] std::string json(Clock::time_point now, int indent) const;

 private:
  template <class Status>
  struct Row {
    Status status;
    Clock::time_point received;
  };
  struct RobotRow : Row<msg::ServiceStatus> {
    double sent_per_s = 0.0;  ///< tasks, between the last two statuses
  };
  struct Total {
    std::size_t workers = 0;
    std::uint64_t slots = 0;
    double busy_slots = 0.0;
    double tasks_per_s = 0.0;
    std::uint64_t tasks_in_hand = 0;
    std::uint64_t open_tasks = 0;  ///< of all robots
  };
  [[nodiscard]] Total total(Clock::time_point now) const;
  [[nodiscard]] std::string state(const Row<msg::WorkerStatus>& row, Clock::time_point now) const;
  [[nodiscard]] static std::string state(const RobotRow& row, Clock::time_point now);
  [[nodiscard]] std::uint64_t faults(const std::string& worker_id) const;
  [[nodiscard]] std::string worker_lines(Clock::time_point now, std::size_t columns,
                                         std::size_t rows) const;
  [[nodiscard]] std::vector<std::string> worker_grid(std::size_t longest_name) const;
  [[nodiscard]] std::string robot_lines(Clock::time_point now, std::size_t columns) const;

  std::string version_;
  std::uint64_t matcher_fingerprint_;
  std::map<std::string, Row<msg::WorkerStatus>> workers_;  // by worker id
  std::map<std::string, std::uint64_t> faults_;            // by worker id
  std::map<std::string, std::string> short_of_cpu_;        // worker ids, with the text for people
  std::map<std::string, RobotRow> robots_;                 // localizers, by robot and instance
  std::map<messaging::Handle, std::string> worker_ids_;
  std::map<messaging::Handle, std::string> service_ids_;  // keys of faults_ or robots_
};

}  // namespace topogeo::cli
