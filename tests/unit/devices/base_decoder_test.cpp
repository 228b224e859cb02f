#include "topogeo/devices/base_decoder.hpp"

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

BaseSettings decoder_settings(BaseDialect dialect) {
  BaseSettings settings;
  settings.dialect = dialect;
  return settings;
}

TEST(BaseDecoder, GivesTheSameReportInEitherDialect) {
  for (const BaseDialect dialect : {BaseDialect::kAscii, BaseDialect::kBinary}) {
    const BaseSettings settings = decoder_settings(dialect);
    McpReport report{.mask = settings.report_mask};
    report.fields[static_cast<std::size_t>(McpField::kX)] = 0x8123;
    std::vector<std::uint8_t> bytes;
    if (dialect == BaseDialect::kAscii) {
      append_ascii(report, {}, bytes);
    } else {
      append_binary_frame(binary_payload(report, McpCommand::kReportMask), bytes);
    }
    BaseDecoder decoder(settings);
    const auto messages = decoder.decode(bytes);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_EQ(std::get<McpReport>(messages[0]).word(McpField::kX), 0x8123);
    EXPECT_EQ(decoder.drops(), McpDrops{});
  }
}

TEST(BaseDecoder, CountsEchoesInAsciiAndForgetsHalfALine) {
  BaseDecoder decoder(decoder_settings(BaseDialect::kAscii));
  const std::string_view bytes = "TH\rRH\r%P";
  (void)decoder.decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  EXPECT_EQ(decoder.echoes(), 2U);
  EXPECT_EQ(decoder.checksum_warnings(), 0U);
  decoder.reset();
  const std::string_view rest = "SR\r";
  (void)decoder.decode({reinterpret_cast<const std::uint8_t*>(rest.data()), rest.size()});
  EXPECT_EQ(count_of(decoder.drops(), McpDrop::kUnknownLine), 1U);
}

}  // namespace
}  // namespace topogeo::devices
