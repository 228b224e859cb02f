// The live services of a domain as tables for people and as JSON for programs.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/status.h"

#include "common/host_units.hpp"
#include "common/text_grid.hpp"
#include "live/unheard_services.hpp"

namespace topogeo::cli {

class StatusTable {
 public:
  using Clock = std::chrono::steady_clock;

  /// Services publish twice a second: one silent for this long hangs or is cut off.
  static constexpr std::chrono::milliseconds kSilent{1500};
  /// Time that a lost service stays in the table, for people who watch it.
  static constexpr std::chrono::seconds kForget = UnheardServices::kRemembered;

  void update(const msg::ServiceStatus& status, const messaging::SampleInfo& info,
              Clock::time_point now);
  /// The service has no writer any more. It stays as "lost" unless its last state was final.
  void remove(const messaging::SampleInfo& info);
  /// Forgets services that have been silent or lost for kForget.
  void forget(Clock::time_point now);
  /// Keeps only services of this name from now on.
  void keep_only(std::string_view service);
  /// Services that must be there: one without a row is shown as "missing", after the others.
  void expect(const std::vector<std::string>& services);
  /// Sets the units of this host that should run but do not.
  void show_units(std::vector<IdleUnit> units) { units_ = std::move(units); }

  /// Sets the services that exist but were never heard, shown as "silent".
  void show_unheard(std::vector<UnheardService> unheard) { unheard_ = std::move(unheard); }

  [[nodiscard]] bool empty() const { return rows_.empty(); }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// Expected services that neither have a row nor are unheard.
  [[nodiscard]] std::vector<std::string> missing() const;
  [[nodiscard]] bool has_idle_units() const { return !units_.empty(); }
  [[nodiscard]] bool has_unheard() const { return !unheard_.empty(); }
  /// Whether no service is failed, lost, silent, deaf or missing, and no unit idle.
  [[nodiscard]] bool healthy(Clock::time_point now) const;

  /// A line for each service by robot, name and instance, no wider than `columns`: state, rate and
  /// age of the main input, faults, reason. Columns with the same value everywhere are left out; a
  /// reason that does not fit goes below. The last line has the totals.
  [[nodiscard]] std::string text(Clock::time_point now, std::size_t columns = kColumns) const;
  /// All fields, in a block of lines per service.
  [[nodiscard]] std::string details(Clock::time_point now) const;
  /// An array of objects with the field names of the IDL; "state" as in the table. Missing services
  /// and units have only name, state and "message".
  [[nodiscard]] std::string json(Clock::time_point now) const;

 private:
  struct Row {
    msg::ServiceStatus status;
    Clock::time_point received;
    bool lost = false;
  };
  using Name = std::pair<std::string, std::string>;  // service, instance
  // An expected item without a status of its own.
  struct Absent {
    std::string name;
    std::string state;
    std::string reason;
  };

  [[nodiscard]] std::vector<Absent> absent() const;
  [[nodiscard]] static bool is_gone(const Row& row, Clock::time_point now);
  /// Why its main input does not arrive (messaging::deafness); empty: some arrives, or none is
  /// sent.
  [[nodiscard]] std::string deafness(const Row& row, Clock::time_point now) const;
  [[nodiscard]] bool unwell(const Row& row, Clock::time_point now) const;
  [[nodiscard]] std::string state(const Row& row, Clock::time_point now) const;
  [[nodiscard]] std::string reason(const Row& row, Clock::time_point now) const;
  [[nodiscard]] static double last_error_age_s(const Row& row, Clock::time_point now);
  [[nodiscard]] static double input_age_s(const Row& row, Clock::time_point now);
  [[nodiscard]] std::vector<const Row*> ordered() const;
  /// Columns that differ between rows.
  struct Shown {
    bool pid = false;
    bool robot = false;
    bool host = false;
  };
  [[nodiscard]] Shown shown() const;
  /// Titles and services, without the reasons.
  [[nodiscard]] std::vector<std::string> lines(Clock::time_point now, const Shown& shown,
                                               std::size_t longest_name) const;
  [[nodiscard]] std::string sums(Clock::time_point now) const;

  std::vector<std::string> expected_;
  std::vector<IdleUnit> units_;
  std::vector<UnheardService> unheard_;
  std::map<Name, Row> rows_;
  std::map<messaging::Handle, Name> names_;
};

}  // namespace topogeo::cli
