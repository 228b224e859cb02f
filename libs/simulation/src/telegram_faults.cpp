#include "topogeo/simulation/telegram_faults.hpp"

namespace topogeo::simulation {
namespace {

/// More telegrams than the longest fault can affect.
constexpr int kAllTelegrams = 1'000'000'000;
constexpr std::uint64_t kMostNoise_bytes = 100;

}  // namespace

void TelegramFaults::set(LaserFault fault, bool on) {
  pending_[index(fault)] = on ? kAllTelegrams : 0;
}

bool TelegramFaults::strikes(LaserFault fault) {
  int& pending = pending_[index(fault)];
  if (pending == 0) return false;
  --pending;
  return true;
}

std::vector<std::uint8_t> TelegramFaults::apply(std::vector<std::uint8_t> telegram) {
  if (!last_.empty() && strikes(LaserFault::kStuckScan)) return last_;
  last_ = telegram;
  std::vector<std::uint8_t> bytes = std::move(telegram);
  if (strikes(LaserFault::kBadChecksum)) {
    bytes[random_.below(bytes.size())] ^= static_cast<std::uint8_t>(1U << random_.below(8));
  }
  if (strikes(LaserFault::kTruncated)) bytes.resize(1 + random_.below(bytes.size() - 1));
  if (strikes(LaserFault::kDoubled)) bytes.insert(bytes.end(), last_.begin(), last_.end());
  if (strikes(LaserFault::kGarbage)) {
    const std::uint64_t count = 1 + random_.below(kMostNoise_bytes);
    for (std::uint64_t i = 0; i < count; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(random_.below(256)));
    }
  }
  return bytes;
}

}  // namespace topogeo::simulation
