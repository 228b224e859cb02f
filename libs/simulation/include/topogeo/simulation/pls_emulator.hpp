// A SICK PLS laser, or an LMS-2xx at its defaults, at the other end of a serial line, byte for
// byte: telegrams, acknowledgements, installation mode, change of the rate, scans at the pace of
// mirror and line, restarts, and typical faults on demand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_telegram.hpp"
#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/simulation/serial_output.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

struct PlsEmulatorSettings {
  /// The line after power-on; without parity the sensor is an LMS.
  devices::LineSettings power_on{9600, devices::Parity::kEven};
  std::string password = "SICK_PLS";
  std::string power_on_text = "PLS 200-313;emulated";
  std::string software = "P 01.23";  ///< seven characters
  std::vector<devices::PlsError> errors{};
  std::int64_t ack_delay_ns = 10'000'000;    ///< between a command's end and ACK; at most 40 ms
  std::int64_t reply_delay_ns = 2'000'000;   ///< between ACK and the reply
  std::int64_t start_up_ns = 9'000'000'000;  ///< between power-on and the power-on telegram
  std::int64_t mirror_period_ns = 40'000'000;
  std::int64_t sweep_to_send_ns = 10'000'000;  ///< middle of the sweep to the first byte
  std::uint16_t no_return_code = 8191;
  /// Radii of the half discs that the sensor watches; 0: none. A PLS supports up to 4 m for a
  /// protective field and about 15 m for a warning field (Thesis, B.3 and table B.3).
  double protective_field_m = 0.0;
  double warning_field_m = 0.0;
  /// Obeys a change of its rate outside of installation mode, too, as an LMS does. A
  /// pseudo-terminal hides the parity of the host, which may then find a PLS without parity and
  /// take it for an LMS.
  bool rate_in_any_mode = false;
  std::uint64_t seed = 1;  ///< of the places of faults
};

/// Faults of the next telegrams.
enum class PlsFault {
  kBadCrc,            ///< a bit of the telegram changes on the line
  kTruncated,         ///< the telegram ends early
  kGarbage,           ///< random bytes after the telegram
  kStuckScan,         ///< a scan is sent again instead of a new one
  kIgnoreBaudSwitch,  ///< a change of the rate is confirmed but not made
};
inline constexpr std::size_t kPlsFaults = 5;

class PlsEmulator final : public LaserEmulator {
 public:
  /// Ranges in metres at a time, one per beam from the right, for 361 or another supported number
  /// of beams; 0 or not finite: no return.
  using Ranges = std::function<std::vector<float>(std::int64_t now_ns)>;

  /// A sensor that was switched on long before `now_ns` and waits for commands. Throws
  /// std::invalid_argument for invalid settings.
  PlsEmulator(PlsEmulatorSettings settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;

  // External events.
  [[nodiscard]] devices::Parity parity() const override { return settings_.power_on.parity; }
  void switch_off() override;
  /// Switches on, or off and on again: silence for the start-up time, then the power-on telegram at
  /// the rate after power-on.
  void switch_on(std::int64_t now_ns) override;
  /// Sets the state that an earlier program may have left: this rate, and streaming or not.
  void set_up(std::uint32_t baud, bool streaming, std::int64_t now_ns);
  /// The byte at the end of every telegram: pollution and errors, for example.
  void set_status(std::uint8_t status) { status_ = status; }
  void set_contaminated(bool contaminated) override;
  /// Changes the fields; see PlsEmulatorSettings. Throws std::invalid_argument out of range.
  void set_fields(double protective_m, double warning_m);

  // Faults.
  /// Applies the fault to the next `count` telegrams, scans or changes of the rate that it
  /// concerns.
  void inject(PlsFault fault, int count);
  void set_fault(LaserFault fault, bool on) override;
  /// Receives nothing either.
  void fall_silent(std::int64_t now_ns) override;
  void speak_again(std::int64_t now_ns) override;
  /// Number of faults still to come.
  [[nodiscard]] int pending(PlsFault fault) const;
  /// Time at which the last faulty telegram left the line, or the silence ended.
  [[nodiscard]] std::int64_t fault_end_ns() const { return fault_end_ns_; }

  [[nodiscard]] const devices::LineSettings& line() const { return line_; }
  [[nodiscard]] bool streaming() const { return mode_ == Mode::kStream; }
  [[nodiscard]] std::uint64_t scans_sent() const override { return scans_sent_; }

 private:
  enum class Power { kOff, kStarting, kOn };
  enum class Mode { kOnRequest, kStream, kInstallation };
  /// State change after a reply has left.
  struct Change {
    std::int64_t at_ns = 0;
    std::optional<Mode> mode{};
    std::optional<std::uint32_t> baud{};
    bool restart = false;
  };
  struct Reply {
    std::uint8_t code = 0;
    std::vector<std::uint8_t> data{};
    Change then{};
  };

  void obey(const devices::SickTelegram& command, std::int64_t now_ns);
  [[nodiscard]] Reply answer(const devices::SickTelegram& command);
  [[nodiscard]] Reply change_mode(std::span<const std::uint8_t> data);
  [[nodiscard]] Reply change_rate(std::uint32_t baud);
  [[nodiscard]] std::vector<std::uint8_t> status_report() const;
  [[nodiscard]] std::vector<std::uint8_t> error_list() const;
  void apply(const Change& change, std::int64_t now_ns);
  void finish_start_up(std::int64_t now_ns);
  void measure(std::int64_t now_ns);
  [[nodiscard]] std::vector<std::uint8_t> scan_data(std::int64_t now_ns);
  [[nodiscard]] std::uint16_t field_bits(float range_m) const;
  std::int64_t send_telegram(std::vector<std::uint8_t> telegram, std::int64_t start_ns);
  [[nodiscard]] bool strikes(PlsFault fault);

  PlsEmulatorSettings settings_;
  Ranges ranges_;
  devices::LineSettings line_;
  devices::SickDecoder decoder_;
  SerialOutput output_;
  support::Random random_;
  Power power_ = Power::kOn;
  Mode mode_ = Mode::kOnRequest;
  bool rate_is_permanent_ = false;
  std::uint8_t status_ = 0;
  std::int64_t mirror_ns_ = 0;                 ///< a time at the mirror's mid-sweep
  std::int64_t start_up_end_ns_ = 0;           ///< while starting
  std::int64_t busy_until_ns_ = 0;             ///< earlier commands are lost
  std::optional<Change> change_;               ///< waits for its time
  std::optional<std::int64_t> measure_at_ns_;  ///< time of the next scan
  std::vector<std::uint8_t> last_scan_;
  std::array<int, kPlsFaults> pending_{};
  bool silent_ = false;
  std::int64_t fault_end_ns_ = 0;
  std::uint64_t scans_sent_ = 0;
};

}  // namespace topogeo::simulation
