// Writes to a base in its dialect, one command at a time: a base loses commands that follow each
// other too fast, and a halt cannot overtake commands that wait in a port.
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

  /// A port was opened: the queue is empty and the line is free.
  void open(std::int64_t now_ns);
  /// The port is gone, and the queue is lost.
  void close();

  /// Earliest time of the next command.
  [[nodiscard]] std::int64_t free_ns() const { return free_ns_; }
  /// Writes at once, even if the line is not free.
  void write(const McpOrder& order, std::int64_t now_ns);
  void write_text(std::string_view text, std::int64_t now_ns);

  /// Replaces the queue by the opening that a base needs: the line's settings, the end of any
  /// truncated command and, in the binary dialect, the change to it.
  void queue_opening();
  void queue(const McpOrder& order);
  /// Queues the zeros that let a base in the binary dialect find the start of the next packet; they
  /// go first.
  void queue_sync();
  void clear_queue() { queue_.clear(); }
  [[nodiscard]] bool queue_empty() const { return queue_.empty(); }
  /// Writes the first command of the queue; false if there is none.
  bool write_queued(std::int64_t now_ns);

  /// Whether take_orders() would return any.
  [[nodiscard]] bool has_orders() const { return !orders_.empty(); }
  /// The orders written since the last call, in order.
  [[nodiscard]] std::vector<LineOrder> take_orders();

 private:
  struct Write {
    LineOrder order{};
    std::int64_t pause_ns = 0;  ///< minimum pause before the next one
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
