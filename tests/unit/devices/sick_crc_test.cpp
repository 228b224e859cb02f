// Telegrams as manufacturers and drivers printed them, and some worked out with a separate script.
#include "topogeo/devices/sick_crc.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(SickCrc, StepsOncePerByte) {
  EXPECT_EQ(sick_crc({}), 0);
  EXPECT_EQ(sick_crc(Bytes{0x02}), 0x0002);
  // A CRC-16 with the same generator that steps once per bit gives 0x8041.
  EXPECT_EQ(sick_crc(Bytes{0x02, 0x00, 0x01, 0x00, 0x31}), 0x1215);
}

}  // namespace
}  // namespace topogeo::devices
