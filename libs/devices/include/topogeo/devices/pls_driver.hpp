// Starts a SICK PLS, or an LMS-2xx at its defaults, keeps it running and hands out its scans.
//
// The driver looks for the rate at which the sensor talks, stops its stream, changes the rate in
// installation mode, with the way back when the sensor does not follow, and has it send scans.
// After a silence, a power-on message or a port that was gone it begins again, where it can with
// what it knew before. It never gives up; a search without success only makes the next one come
// later.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/pls_scan.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_exchange.hpp"
#include "topogeo/devices/sick_telegram.hpp"

namespace topogeo::devices {

enum class PlsState {
  kOffline,      ///< there is no port
  kDetecting,    ///< the sensor is looked for
  kConfiguring,  ///< it answers, and is told what to do
  kRunning,      ///< it sends scans
  kFailed,       ///< it was looked for more than once; the search goes on
};
[[nodiscard]] const char* to_string(PlsState state);

struct PlsCounters {
  SickCounters line;              ///< of the decoder
  PlsScanDrops scan_drops;        ///< of scans received whole
  std::uint64_t scans = 0;        ///< handed on
  std::uint64_t unsolicited = 0;  ///< scans that came while the sensor was being set up
  std::uint64_t timeouts = 0;     ///< commands without ACK or reply in time
  std::uint64_t repeats = 0;      ///< commands sent again
  std::uint64_t refusals = 0;     ///< commands refused by the sensor
  std::uint64_t restarts = 0;     ///< power-on messages
  std::uint64_t silences = 0;     ///< scans stayed away until the sensor was looked for anew
  std::uint64_t searches = 0;     ///< searches without success
  std::uint64_t switches_not_followed = 0;  ///< changes of the rate
  std::uint64_t openings = 0;               ///< of the port
};

struct PlsStatus {
  PlsState state = PlsState::kOffline;
  std::string reason =
      "the port is closed";      ///< what is going on, or wrong; empty while all is well
  LineSettings line;             ///< of the port at present
  bool lms = false;              ///< an LMS, by its parity
  PlsHealth health{};            ///< of the last telegram; polluted: the window is dirty
  bool stuck = false;            ///< scans are dropped because they repeat
  std::string power_on_text;     ///< what the sensor called itself
  std::string software;          ///< its version; empty if it did not say
  std::vector<PlsError> errors;  ///< in its memory, when it was started up
  PlsCounters counters;
};

class PlsDriver final : public SerialDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  explicit PlsDriver(PlsSettings settings);

  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;

  /// The scans received since the last call, in order.
  [[nodiscard]] std::vector<PlsScan> take_scans();
  [[nodiscard]] PlsStatus status() const;

 private:
  enum class Phase {
    kOffline,
    kSearch,   ///< listening at one of the candidates after a probe
    kPause,    ///< listening at the power-on rate between two searches
    kStop,     ///< stopping the stream
    kInstall,  ///< asking for installation mode
    kRate,     ///< asking for the rate
    kSettle,   ///< resting after a change of the rate
    kProve,    ///< asking for an answer at the new rate
    kStatus,
    kErrors,
    kMonitor,  ///< asking for scans
    kRun,
  };

  void handle_events(std::int64_t now_ns);
  void handle_telegram(const SickTelegram& telegram, std::int64_t now_ns);
  void handle_scan(const SickTelegram& telegram, std::int64_t now_ns);
  void handle_power_on(const SickTelegram& telegram, std::int64_t now_ns);
  void handle_reply(const SickTelegram& telegram, std::int64_t now_ns);
  void note(const SickTelegram& telegram);

  void start_search(const std::string& reason, bool listen_first, std::int64_t now_ns);
  void plan_search();
  void try_candidate(const LineSettings& line, bool listen_only, std::int64_t now_ns);
  void next_candidate(std::int64_t now_ns);
  void watch_search(std::int64_t now_ns);
  [[nodiscard]] std::int64_t search_due_ns() const;
  void watch_for_stream(std::int64_t now_ns);
  void pause(const std::string& reason, int failures, std::int64_t now_ns);
  void found(const SickTelegram& telegram, std::int64_t now_ns);

  void start_phase(Phase phase, std::int64_t now_ns);
  void ask(std::vector<std::uint8_t> command, std::int64_t now_ns);
  void go_on(std::int64_t now_ns);
  void after_stop(std::int64_t now_ns);
  void after_install(std::int64_t now_ns);
  void after_rate(std::int64_t now_ns);
  void after_prove(std::int64_t now_ns);
  void after_monitor(std::int64_t now_ns);
  void after_request(std::int64_t now_ns);
  void give_up(const std::string& reason, std::int64_t now_ns);
  void run(std::int64_t now_ns);
  void watch_run(std::int64_t now_ns);

  void set_line(const LineSettings& line);
  void write(std::vector<std::uint8_t> bytes);
  void flush_exchange();
  void enter(Phase phase, PlsState state, std::string reason);
  [[nodiscard]] bool lms() const { return line_.parity == Parity::kNone; }
  [[nodiscard]] LineSettings power_on_line() const;
  [[nodiscard]] std::uint64_t drops() const;
  [[nodiscard]] std::int64_t scan_time_ns() const;
  [[nodiscard]] std::int64_t silence_ns() const;
  [[nodiscard]] std::int64_t silent_at_ns() const;

  PlsSettings settings_;
  SickDecoder decoder_;
  SickExchange exchange_;
  PlsScanMaker maker_;
  PlsStatus status_;
  Phase phase_ = Phase::kOffline;
  LineSettings line_;
  std::vector<LineOrder> orders_;
  std::vector<PlsScan> scans_;

  std::optional<LineSettings> known_;  ///< where the sensor was heard last
  bool configured_ = false;            ///< it was told to send scans and did not restart since
  std::vector<LineSettings> candidates_;
  std::size_t candidate_ = 0;
  bool listen_only_ = false;  ///< the sensor may be sending scans, which a probe would stop
  std::int64_t candidate_since_ns_ = 0;
  std::uint64_t drops_before_ = 0;  ///< of the decoder, when the line was last set
  int failed_searches_ = 0;
  int failed_setups_ = 0;
  int failed_switches_ = 0;
  std::string fallback_;            ///< why the sensor is used at another rate than wanted
  std::int64_t wait_until_ns_ = 0;  ///< end of a pause or rest, or when the next scan is asked for
  std::int64_t last_byte_ns_ = 0;
  std::int64_t last_scan_ns_ = 0;
};

}  // namespace topogeo::devices
