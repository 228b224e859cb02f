#include "topogeo/devices/sick_crc.hpp"

namespace topogeo::devices {
namespace {

constexpr std::uint32_t kGenerator = 0x8005;

}  // namespace

std::uint16_t sick_crc(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0;
  std::uint32_t previous = 0;
  for (const std::uint8_t byte : bytes) {
    const std::uint32_t carry = (crc >> 15) & 1U;
    crc = ((crc << 1) & 0xFFFFU) ^ (carry * kGenerator) ^ (previous << 8 | byte);
    previous = byte;
  }
  return static_cast<std::uint16_t>(crc);
}

}  // namespace topogeo::devices
