#include "topogeo/devices/base_writer.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"

namespace topogeo::devices {
namespace {

std::int64_t pause_ns(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e9);
}

std::vector<std::uint8_t> bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

}  // namespace

void BaseWriter::open(std::int64_t now_ns) {
  close();
  free_ns_ = now_ns;
}

void BaseWriter::close() {
  queue_.clear();
  orders_.clear();
}

BaseWriter::Write BaseWriter::write_of(const McpOrder& order) const {
  Write write{{}, pause_ns(settings_.write_gap_s)};
  if (settings_.dialect == BaseDialect::kBinary) {
    const McpPacket packet = binary_packet(order);
    write.order.bytes.assign(packet.begin(), packet.end());
  } else {
    append_ascii(order, write.order.bytes);
  }
  return write;
}

BaseWriter::Write BaseWriter::sync() const {
  return {{{}, std::vector<std::uint8_t>(kMcpSyncZeros)}, pause_ns(settings_.write_gap_s)};
}

void BaseWriter::write(const McpOrder& order, std::int64_t now_ns) {
  put(write_of(order), now_ns);
}

void BaseWriter::write_text(std::string_view text, std::int64_t now_ns) {
  put({{{}, bytes_of(text)}, pause_ns(settings_.write_gap_s)}, now_ns);
}

void BaseWriter::queue_opening() {
  queue_.clear();
  if (settings_.dialect == BaseDialect::kBinary) {
    queue_.push_back(
        {{settings_.line, bytes_of("\rBE FFFF\rDM\r")}, pause_ns(settings_.direct_mode_wait_s)});
    queue_.push_back(sync());
  } else {
    queue_.push_back({{settings_.line, bytes_of("\r")}, pause_ns(settings_.write_gap_s)});
  }
}

void BaseWriter::queue(const McpOrder& order) {
  queue_.push_back(write_of(order));
}

void BaseWriter::queue_sync() {
  queue_.push_front(sync());
}

bool BaseWriter::write_queued(std::int64_t now_ns) {
  if (queue_.empty()) return false;
  Write next = std::move(queue_.front());
  queue_.pop_front();
  put(std::move(next), now_ns);
  return true;
}

void BaseWriter::put(Write write, std::int64_t now_ns) {
  const std::int64_t line_ns = line_time_ns(write.order.bytes.size(), settings_.line);
  free_ns_ = std::max(free_ns_, now_ns) + std::max(line_ns, write.pause_ns);
  orders_.push_back(std::move(write.order));
}

std::vector<LineOrder> BaseWriter::take_orders() {
  return std::exchange(orders_, {});
}

}  // namespace topogeo::devices
