// Writes to a base in its dialect, one command at a time: a base loses commands that follow each
// other too fast, and what waits in a port can no longer be overtaken by a halt.
#pragma once

#include <cstdint>
#include <deque>
#include <string_view>
#include <vector>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

class BaseWriter {
 public:
  explicit BaseWriter(const BaseSettings& settings) : settings_(settings) {}

  /// A port was opened: nothing is to be written, and the line is free.
  void open(std::int64_t now_ns);
  /// The port is gone, with all that was to be written.
  void close();

  /// When the next command may be written.
  [[nodiscard]] std::int64_t free_ns() const { return free_ns_; }
  /// Writes at once, whether the line is free or not.
  void write(const McpOrder& order, std::int64_t now_ns);
  void write_text(std::string_view text, std::int64_t now_ns);

  /// Replaces what waits by what a base has to hear first: the line's settings, the end of any
  /// command that was cut short and, in the binary dialect, the change to it.
  void queue_opening();
  void queue(const McpOrder& order);
  /// Zeros by which a base in the binary dialect finds the start of the next packet; they go first.
  void queue_sync();
  void clear_queue() { queue_.clear(); }
  [[nodiscard]] bool queue_empty() const { return queue_.empty(); }
  /// Writes the first of the queue; false if there is none.
  bool write_queued(std::int64_t now_ns);

  /// take_orders() would return some.
  [[nodiscard]] bool has_orders() const { return !orders_.empty(); }
  /// What was written since the last call, in order.
  [[nodiscard]] std::vector<LineOrder> take_orders();

 private:
  struct Write {
    LineOrder order{};
    std::int64_t pause_ns = 0;  ///< to the next, in any case
  };
  [[nodiscard]] Write write_of(const McpOrder& order) const;
  [[nodiscard]] Write sync() const;
  void put(Write write, std::int64_t now_ns);

  BaseSettings settings_;
  std::deque<Write> queue_{};
  std::vector<LineOrder> orders_{};
  std::int64_t free_ns_ = 0;
};

}  // namespace topogeo::devices
