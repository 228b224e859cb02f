// Telegrams printed by manufacturers and drivers, and some computed with a separate script.
#include "topogeo/devices/sick_crc.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sick_streams.hpp"

namespace topogeo::devices {
namespace {

void expect_crc(const Bytes& telegram) {
  ASSERT_GE(telegram.size(), 7U);
  const std::span<const std::uint8_t> checked = std::span(telegram).first(telegram.size() - 2);
  const int low = telegram[telegram.size() - 2];
  const int high = telegram.back();
  EXPECT_EQ(sick_crc(checked), high << 8 | low) << ::testing::PrintToString(telegram);
}

TEST(SickCrc, StepsOncePerByte) {
  EXPECT_EQ(sick_crc({}), 0);
  EXPECT_EQ(sick_crc(Bytes{0x02}), 0x0002);
  // A CRC-16 with the same generator that steps once per bit gives 0x8041.
  EXPECT_EQ(sick_crc(hex("02 00 01 00 31")), 0x1215);
}

TEST(SickCrc, IsThatOfPrintedTelegrams) {
  for (const char* text : {
           "02 00 01 00 31 15 12",
           "02 00 02 00 30 01 31 18",
           "02 00 02 00 20 24 34 08",
           "02 00 02 00 20 25 35 08",
           "02 00 02 00 20 40 50 08",
           "02 00 02 00 20 41 51 08",
           "02 00 02 00 20 42 52 08",
           "02 00 02 00 20 43 53 08",
           "02 00 02 00 20 48 58 08",
           "02 00 0A 00 20 00 53 49 43 4B 5F 50 4C 53 CC FC",
           "02 00 0A 00 20 00 53 49 43 4B 5F 4C 4D 53 BE C5",
           "02 00 02 00 66 01 9D 4E",
           "02 81 03 00 A0 00 10 36 1A",
           "02 00 05 00 3B B4 00 32 00 3B 1F",
           "02 81 07 00 BB 01 B4 00 32 00 10 06 1F",
       }) {
    expect_crc(hex(text));
  }
}

TEST(SickCrc, IsThatOfTelegramsOfASeparateScript) {
  for (const char* text : {
           "02 00 01 00 10 34 12",
           "02 00 01 00 32 16 12",
           "02 00 01 00 3A 1E 12",
           "02 00 03 00 30 05 B4 CE 3D",
           "02 00 02 00 20 20 30 08",
           "02 00 02 00 20 10 00 08",
           "02 00 06 00 20 27 01 00 69 01 AB D4",
           "02 00 02 00 66 00 9C 4E",
           "02 80 03 00 A0 00 00 06 0A",
           "02 80 03 00 A0 00 10 16 0A",
           "02 80 03 00 A0 01 00 04 0B",
           "02 80 02 00 92 00 6F 33",
           "02 80 02 00 91 00 69 30",
           "02 80 0E 00 B0 05 00 50 02 80 02 23 21 00 48 FF 9F 00 B4 96",
       }) {
    expect_crc(hex(text));
  }
}

TEST(SickCrc, SeesEveryChangeOfOneBitInAScan) {
  Bytes telegram = measured_values(std::vector<std::uint16_t>(361, 640));
  telegram.resize(telegram.size() - 2);
  const std::uint16_t crc = sick_crc(telegram);
  for (std::size_t bit = 0; bit < telegram.size() * 8; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    telegram[bit / 8] ^= mask;
    ASSERT_NE(sick_crc(telegram), crc) << "bit " << bit;
    telegram[bit / 8] ^= mask;
  }
}

}  // namespace
}  // namespace topogeo::devices
