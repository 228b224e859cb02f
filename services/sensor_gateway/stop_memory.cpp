#include "stop_memory.hpp"

#include <system_error>

namespace topogeo::sensor_gateway {
namespace {

constexpr std::uint64_t kStopFormat = 0x31504F5453475054;  // "TPGSTOP1": the layout of the record

bool has_content(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size_bytes = std::filesystem::file_size(path, error);
  return !error && size_bytes > 0;
}

}  // namespace

StopMemory::StopMemory(const std::filesystem::path& path)
    : damaged_(has_content(path)), file_(path, kStopFormat) {
  if (const std::optional<Record> record = file_.load()) {
    damaged_ = false;
    held_ = {record->emergency_stop != 0, record->halt != 0};
    return;
  }
  held_.halt = damaged_;
  // Takes the room in the file now: a later stop overwrites it, on a full disk too.
  written_ = write(held_);
}

bool StopMemory::store(const devices::HeldStops& held) {
  if (written_ && held == held_) return true;
  written_ = write(held);
  if (written_) held_ = held;
  return written_;
}

}  // namespace topogeo::sensor_gateway
