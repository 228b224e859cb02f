// Starts a SICK PLS, or an LMS-2xx at its defaults, keeps it running and returns its scans.
//
// The driver searches for the sensor's rate, stops its stream, changes the rate in installation
// mode (returning to the old one if the sensor does not follow) and starts the scans. After a
// silence, a power-on message or the loss of the port it begins again, if possible with the line
// settings that it knew. It never gives up; a failed search only delays the next one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/pls_line.hpp"
#include "topogeo/devices/pls_scan.hpp"
#include "topogeo/devices/pls_search.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/pls_setup.hpp"
#include "topogeo/devices/pls_status.hpp"
#include "topogeo/devices/pls_supervisor.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_exchange.hpp"
#include "topogeo/devices/sick_telegram.hpp"

namespace topogeo::devices {

class PlsDriver final : public LaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  explicit PlsDriver(PlsSettings settings);

  /// A wrong line costs one more attempt.
  void resume(const LineSettings& line) override;

  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;

  [[nodiscard]] std::vector<LaserScan> take_scans() override;
  [[nodiscard]] LaserHealth health() const override;
  [[nodiscard]] PlsStatus status() const;

 private:
  enum class Phase : std::uint8_t {
    kOffline,
    kSearch,
    kRest,  ///< between two searches
    kSetUp,
    kRun,
  };

  void take_events(std::int64_t now_ns);
  void take(const SickTelegram& telegram, std::int64_t now_ns);
  void take_scan(const SickTelegram& telegram, std::int64_t now_ns);
  void take_power_on(const SickTelegram& telegram, std::int64_t now_ns);
  void take_reply(const SickTelegram& telegram, std::int64_t now_ns);
  void note(const SickTelegram& telegram);
  void follow_garbage(std::int64_t now_ns);

  void search(const std::string& reason, bool listen_first, std::int64_t now_ns);
  void rest(const std::string& reason, int failures, std::int64_t now_ns);
  void found(const SickTelegram& telegram, std::int64_t now_ns);
  void exchange_ended(std::int64_t now_ns);
  void run(std::int64_t now_ns);
  void supervise(std::int64_t now_ns);

  void enter(Phase phase, PlsState state, std::string reason);
  void enter_search(Phase phase, int failures, const std::string& reason);
  void enter_setup();

  PlsSettings settings_;
  PlsLine line_;
  SickExchange exchange_;
  PlsScanMaker maker_;
  PlsSearch search_;
  PlsSetup setup_;
  PlsSupervisor supervisor_;

  Phase phase_ = Phase::kOffline;
  bool configured_ = false;  ///< it was made to send scans and has not restarted since
  std::vector<LaserScan> scans_;
  PlsStatus status_;
};

}  // namespace topogeo::devices
