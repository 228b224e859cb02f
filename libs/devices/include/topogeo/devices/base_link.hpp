// Connection to a base: sets it up, waits for its reports, notices when they cease and checks now
// and then whether it is back.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/base_writer.hpp"

namespace topogeo::devices {

class BaseLink {
 public:
  /// Result of a message or of passed time.
  enum class Change : std::uint8_t {
    kNone,
    kSetUp,    ///< the base is set up from scratch
    kRunning,  ///< it reports after it was set up
    kResumed,  ///< it reports again and has kept its settings
    kOffline   ///< it does not answer, see reason()
  };

  /// Keeps a reference to `writer`, which it also empties.
  BaseLink(const BaseSettings& settings, BaseWriter& writer);

  /// The port is open; kSetUp follows.
  void open(std::int64_t now_ns);
  /// The port is gone; kOffline follows.
  void close();
  /// A usable report came; `restarted`: the base's clock was reset.
  Change reported(bool restarted, std::int64_t now_ns);
  /// Any bytes came, after their messages were handled.
  Change received(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// The base gave a sign of life other than a report. If no reports follow, it is set up when the
  /// next probe would be due.
  void answered() { answered_ = true; }
  Change tick(std::int64_t now_ns);
  [[nodiscard]] std::int64_t due_ns() const;

  [[nodiscard]] bool closed() const { return phase_ == Phase::kClosed; }
  [[nodiscard]] bool running() const { return phase_ == Phase::kRunning; }
  [[nodiscard]] bool offline() const { return closed() || !reason_.empty(); }
  /// The reason why it is offline.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// Number of times the base was set up.
  [[nodiscard]] std::uint64_t starts() const { return starts_; }

 private:
  enum class Phase : std::uint8_t {
    kClosed,
    kStarting,  ///< the start sequence is being written
    kWaiting,   ///< waits for the first report after that
    kRunning,
    kProbing  ///< waits for any answer to a question
  };

  void start(std::int64_t now_ns);
  void probe(std::int64_t now_ns);
  [[nodiscard]] bool restarted(std::span<const std::uint8_t> bytes);

  BaseSettings settings_;
  BaseWriter& writer_;
  std::int64_t period_ns_;
  std::int64_t silence_ns_;
  Phase phase_ = Phase::kClosed;
  std::string reason_;
  std::int64_t heard_ns_ = 0;        // arrival of the last usable report
  std::int64_t started_ns_ = 0;      // last setup of the base
  std::int64_t phase_until_ns_ = 0;  // end of kWaiting or kProbing
  bool reconnects_ = false;          // kStarting after a silence
  bool answered_ = false;            // since the last start
  std::string probe_answer_{};       // last bytes received since the last question
  std::uint64_t starts_ = 0;
};

}  // namespace topogeo::devices
