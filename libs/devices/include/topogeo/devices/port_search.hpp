// Finds out what is connected to a serial port, without moving it: listens first, and asks only a
// port that is silent. The questions are requests of lasers that no base obeys as an order to move;
// the source has the reason for each. A device that sends something unknown is never asked, and one
// that echoes a question gets no other: an RWI base may do so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/port_recognizer.hpp"
#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

class PortSearch final : public SerialDriver {
 public:
  enum class Link : std::uint8_t { kSerial, kNetwork };

  /// `asks`: false to listen only. A network connection has no rates, and asks lasers with one.
  explicit PortSearch(bool asks = true, Link link = Link::kSerial) : asks_(asks), link_(link) {}

  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;

  /// The search is over: nothing more is written.
  [[nodiscard]] bool done() const { return done_; }
  [[nodiscard]] const std::optional<RecognizedDevice>& device() const { return device_; }
  /// The device answered a question; otherwise it was heard.
  [[nodiscard]] bool asked() const { return asking_; }
  /// Bytes that came at any setting.
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// The outcome without a device, for people.
  [[nodiscard]] std::string why_none() const;

 private:
  struct Stage {
    LineSettings line;
    std::int64_t duration_ns = 0;
    PortRecognizer::Question question = PortRecognizer::Question::kNone;
  };
  [[nodiscard]] static std::deque<Stage> listening();
  [[nodiscard]] static std::deque<Stage> questions(Link link);
  void begin(std::int64_t now_ns);
  /// Plans what follows the stages that are over; false: nothing.
  [[nodiscard]] bool plan();

  bool asks_;
  Link link_;
  bool done_ = false;
  bool asking_ = false;
  bool other_rates_ = false;  // listened at the other rates, too
  std::deque<Stage> stages_;  // the first is the present one
  std::int64_t ends_ns_ = 0;
  std::optional<PortRecognizer> recognizer_;
  std::size_t bytes_ = 0;
  std::vector<std::uint8_t> answer_;  // bytes of the present stage
  bool echoes_ = false;
  std::optional<RecognizedDevice> device_;
  std::vector<LineOrder> orders_;
};

}  // namespace topogeo::devices
