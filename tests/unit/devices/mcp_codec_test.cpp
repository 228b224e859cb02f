// The byte vectors of the protocol's description, both directions, and streams with noise in them.
#include <cstdint>
#include <initializer_list>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"

namespace topogeo::devices {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Messages = std::vector<McpMessage>;

Bytes bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

std::string line_of(const McpOrder& order) {
  Bytes bytes;
  append_ascii(order, bytes);
  return {bytes.begin(), bytes.end()};
}

Bytes packet_of(const McpOrder& order) {
  const McpPacket packet = binary_packet(order);
  return {packet.begin(), packet.end()};
}

Bytes frame_of(const Bytes& payload) {
  Bytes frame;
  append_binary_frame(payload, frame);
  return frame;
}

constexpr std::uint32_t kAsciiMask = 0x000A0A7A;
constexpr std::uint32_t kBinaryMask = 0x000B0BF7;

McpReport ascii_report() {
  McpReport report{.mask = kAsciiMask};
  report.fields[1] = 0x12A40;
  report.fields[3] = 0xFFFF;
  report.fields[4] = 0x806E;
  report.fields[5] = 0x8000;
  report.fields[6] = 0x0100;
  report.fields[9] = 0x0AFC;
  report.fields[11] = 0x4002;
  report.fields[19] = 0x0004;
  return report;
}

constexpr std::string_view kAsciiReport =
    "%PSR\rCLK 00012a40\rBBS ffff\rBPX 806e\rBPY 8000\rTPH 0100\rTVE 0afc\rTSF 4002\rRVE 0000\r"
    "RSF 0004\r";

McpReport binary_report() {
  McpReport report{.mask = kBinaryMask};
  report.fields[0] = kBinaryMask;
  report.fields[1] = 0x200;
  report.fields[4] = 0x8000;
  report.fields[5] = 0x806E;
  report.fields[7] = 0x0200;
  report.fields[9] = 0x0AFC;
  report.fields[11] = 0x4002;
  report.fields[19] = 0x8004;
  return report;
}

const Bytes kBinaryReport{0x02, 0x02, 0x1F, 0x11, 0x00, 0x0B, 0x0B, 0xF7, 0x00, 0x00,
                          0x02, 0x00, 0x00, 0x00, 0x00, 0x80, 0x00, 0x80, 0x6E, 0x00,
                          0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x0A, 0xFC, 0x40, 0x02,
                          0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x04, 0xB8, 0x03, 0x03};

Messages from_ascii(std::string_view text, McpAsciiDecoder& decoder) {
  Messages messages;
  decoder.decode(bytes_of(text), messages);
  return messages;
}

Messages from_ascii(std::string_view text) {
  McpAsciiDecoder decoder(kAsciiMask);
  return from_ascii(text, decoder);
}

Messages from_binary(const Bytes& bytes, McpBinaryDecoder& decoder) {
  Messages messages;
  decoder.decode(bytes, messages);
  return messages;
}

Messages from_binary(const Bytes& bytes) {
  McpBinaryDecoder decoder;
  return from_binary(bytes, decoder);
}

TEST(McpAscii, WritesCommandsWithHexadecimalArguments) {
  EXPECT_EQ(line_of({McpCommand::kTranslateVelocity, 2812}), "TV afc\r");
  EXPECT_EQ(line_of({McpCommand::kJoystickOff, 1}), "JD 1\r");
  EXPECT_EQ(line_of({McpCommand::kHalfDuplex}), "HD\r");
  EXPECT_EQ(line_of({McpCommand::kReportMask, kAsciiMask}), "SD a0a7a\r");
  EXPECT_EQ(line_of({McpCommand::kTranslateForward, 0xFFFFFFFF}), "T> ffffffff\r");
  EXPECT_EQ(line_of({McpCommand::kRotateMinus}), "R-\r");
}

TEST(McpAscii, RefusesArgumentsThatDoNotFitAndCommandsWithoutName) {
  EXPECT_THROW(line_of({McpCommand::kTranslateVelocity, 0x10000}), std::invalid_argument);
  EXPECT_THROW(line_of({McpCommand::kJoystickOff, 0x100}), std::invalid_argument);
  EXPECT_THROW(line_of({McpCommand::kFullDuplex}), std::invalid_argument);
}

TEST(McpAscii, ReadsTheReport) {
  EXPECT_EQ(from_ascii(kAsciiReport), Messages{ascii_report()});
}

TEST(McpAscii, WritesTheReport) {
  Bytes bytes;
  append_ascii(ascii_report(), {.line_end = "\r"}, bytes);
  EXPECT_EQ(std::string(bytes.begin(), bytes.end()), kAsciiReport);
}

TEST(McpAscii, ReadsReportsHoweverLinesEndWithPromptsPaddingAndCapitals) {
  const std::string lines =
      "%PSR\r\n*CLK 00012A40\r\n\r\nBBS FFFF\nBPX 806E\nBPY 8000\r\n* TPH  100\r\nTVE  afc\r\n"
      "TSF 4002\r\nRVE    0\r\nRSF    4\r\n";
  EXPECT_EQ(from_ascii(lines), Messages{ascii_report()});
}

TEST(McpAscii, ReadsAReportThatStartsWithTheClock) {
  EXPECT_EQ(from_ascii(kAsciiReport.substr(5)), Messages{ascii_report()});
}

TEST(McpAscii, DropsAReportWithAnyDeviationWholeAndCountsItOnce) {
  const std::string good(kAsciiReport);
  std::vector<std::string> bad;
  for (std::size_t i = 5; i < good.size(); ++i) {
    bad.push_back(good.substr(0, i) + good.substr(i + 1));  // a character missing
    if (good[i] != '\r') bad.push_back(good.substr(0, i) + 'x' + good.substr(i));  // one too many
  }
  for (const std::string& report : bad) {
    McpAsciiDecoder decoder(kAsciiMask);
    EXPECT_EQ(from_ascii(report + good, decoder), Messages{ascii_report()}) << report;
    EXPECT_EQ(count_of(decoder.drops(), McpDrop::kBadReport), 1U) << report;
  }
}

TEST(McpAscii, ReadsEventsAlsoWithinAReport) {
  const auto event = [](McpEventKind kind, std::uint32_t value = 0) {
    return McpMessage(McpEvent{kind, value});
  };
  EXPECT_EQ(
      from_ascii("%BS fff7\r%BHI\r%BLO\r%TERR\r%TC1\r%TCLR\r%RERR\r%RC1\r%RCLR\r"
                 "%WDT motors stopped\r"),
      (Messages{event(McpEventKind::kBump, 0xFFF7), event(McpEventKind::kBatteryHigh),
                event(McpEventKind::kBatteryLow), event(McpEventKind::kTranslateError),
                event(McpEventKind::kTranslateCurrent), event(McpEventKind::kTranslateCleared),
                event(McpEventKind::kRotateError), event(McpEventKind::kRotateCurrent),
                event(McpEventKind::kRotateCleared), event(McpEventKind::kWatchdogExpired)}));
  const std::string report(kAsciiReport);
  EXPECT_EQ(from_ascii(report.substr(0, 18) + "%BS fff7\r" + report.substr(18)),
            (Messages{event(McpEventKind::kBump, 0xFFF7), ascii_report()}));
}

TEST(McpAscii, TellsAnswersFromEchoes) {
  McpAsciiDecoder decoder(kAsciiMask);
  EXPECT_EQ(from_ascii("BV\rTV afc\rHD\rSD a0a7a\r*BV 1e2\r", decoder),
            (Messages{McpAnswer{McpCommand::kBatteryVoltage, 482}}));
  EXPECT_EQ(decoder.echoes(), 4U);
  EXPECT_EQ(decoder.drops(), McpDrops{});
}

TEST(McpAscii, ReadsAReportWithEchoesBetweenItsLines) {
  std::string report(kAsciiReport);
  report.insert(18, "WD 100\r");
  report.insert(5, "TV\r");
  EXPECT_EQ(from_ascii(report), Messages{ascii_report()});
}

TEST(McpAscii, CountsLinesThatMeanNothing) {
  McpAsciiDecoder decoder(kAsciiMask);
  EXPECT_EQ(from_ascii("hello\r%XYZ\rBV 1e2 x\r" + std::string(200, 'y') + "\r", decoder),
            Messages{});
  EXPECT_EQ(count_of(decoder.drops(), McpDrop::kUnknownLine), 3U);
  EXPECT_EQ(count_of(decoder.drops(), McpDrop::kLongLine), 1U);
}

TEST(McpBinary, WritesPackets) {
  const auto expect = [](const McpOrder& order, const Bytes& packet) {
    EXPECT_EQ(packet_of(order), packet);
  };
  expect({McpCommand::kSync}, {0x00, 0x00, 0x00, 0x00, 0x00, 0x00});
  expect({McpCommand::kReportMask, kBinaryMask}, {0x11, 0x00, 0x0B, 0x0B, 0xF7, 0xE6});
  expect({McpCommand::kReportPeriod, 26}, {0x12, 0x00, 0x00, 0x00, 0x1A, 0x08});
  expect({McpCommand::kWatchdog, 512}, {0x16, 0x00, 0x00, 0x02, 0x00, 0x14});
  expect({McpCommand::kWatchdog, 0}, {0x16, 0x00, 0x00, 0x00, 0x00, 0x16});
  expect({McpCommand::kTranslateVelocity, 2812}, {0x20, 0x00, 0x00, 0x0A, 0xFC, 0xD6});
  expect({McpCommand::kTranslateAcceleration, 5624}, {0x21, 0x00, 0x00, 0x15, 0xF8, 0xCC});
  expect({McpCommand::kTranslatePlus}, {0x26, 0x00, 0x00, 0x00, 0x00, 0x26});
  expect({McpCommand::kTranslateHalt}, {0x22, 0x00, 0x00, 0x00, 0x00, 0x22});
  expect({McpCommand::kRotateVelocity, 128}, {0x40, 0x00, 0x00, 0x00, 0x80, 0xC0});
  expect({McpCommand::kRotatePositive, 256}, {0x44, 0x00, 0x00, 0x01, 0x00, 0x45});
  expect({McpCommand::kJoystickOff, 1}, {0x0E, 0x00, 0x00, 0x00, 0x01, 0x0F});
  expect({McpCommand::kKill}, {0x02, 0x00, 0x00, 0x00, 0x00, 0x02});
}

TEST(McpBinary, ReadsAndWritesFrames) {
  const auto expect = [](const Bytes& payload, const Bytes& frame, const McpMessage& message) {
    EXPECT_EQ(frame_of(payload), frame);
    EXPECT_EQ(from_binary(frame), Messages{message});
  };
  expect({0x16}, {0x02, 0x02, 0x01, 0x16, 0x16, 0x03, 0x03},
         McpEvent{McpEventKind::kWatchdogExpired, 0});
  expect({0x01, 0x01}, {0x02, 0x02, 0x02, 0x00, 0x01, 0x01, 0x00, 0x03, 0x03},
         McpEvent{McpEventKind::kTranslateError, 0});
  expect({0x60, 0x01, 0xE2}, {0x02, 0x02, 0x03, 0x00, 0x60, 0x01, 0xE2, 0x83, 0x03, 0x03},
         McpAnswer{McpCommand::kBatteryVoltage, 482});
  expect({0x00}, {0x02, 0x02, 0x01, 0x00, 0x00, 0x03, 0x03}, McpEvent{McpEventKind::kLostSync, 0});
  EXPECT_EQ(kBinaryReport.size(), 40U);
  expect(binary_payload(binary_report(), McpCommand::kReportMask), kBinaryReport, binary_report());
}

TEST(McpBinary, RefusesPayloadsThatNoFrameHolds) {
  EXPECT_THROW(frame_of({}), std::invalid_argument);
  EXPECT_THROW(frame_of(Bytes(256)), std::invalid_argument);
}

TEST(McpBinary, ReadsEveryErrorOfAByte) {
  EXPECT_EQ(from_binary(frame_of({0x01, 0x2A})),
            (Messages{McpEvent{McpEventKind::kTranslateCurrent, 0},
                      McpEvent{McpEventKind::kRotateCurrent, 0},
                      McpEvent{McpEventKind::kBatteryLow, 0}}));
}

TEST(McpBinary, TakesOrDropsWrongChecksumsAsToldTo) {
  Bytes wrong = kBinaryReport;
  wrong[37] ^= 0x40U;
  const auto reports = [&](McpChecksum rule, bool first_right) {
    McpBinaryDecoder decoder(rule);
    if (first_right) {
      for (int i = 0; i < 3; ++i) (void)from_binary(kBinaryReport, decoder);
    }
    const std::size_t taken = from_binary(wrong, decoder).size();
    EXPECT_EQ(decoder.checksum_warnings(), taken);
    EXPECT_EQ(count_of(decoder.drops(), McpDrop::kChecksum), 1 - taken);
    return taken;
  };
  EXPECT_EQ(reports(McpChecksum::kWarn, true), 1U);
  EXPECT_EQ(reports(McpChecksum::kDrop, false), 0U);
  EXPECT_EQ(reports(McpChecksum::kLearn, false), 1U);
  EXPECT_EQ(reports(McpChecksum::kLearn, true), 0U);
}

TEST(McpBinary, DropsReportsWhoseLengthDoesNotFitTheirMask) {
  Bytes payload = binary_payload(binary_report(), McpCommand::kReportMask);
  payload.pop_back();
  McpBinaryDecoder decoder;
  EXPECT_EQ(from_binary(frame_of(payload), decoder), Messages{});
  EXPECT_EQ(from_binary(frame_of({0x11, 0x00}), decoder), Messages{});
  EXPECT_EQ(count_of(decoder.drops(), McpDrop::kBadReport), 2U);
  EXPECT_EQ(from_binary(frame_of({0x7E, 0x01}), decoder), Messages{});
  EXPECT_EQ(count_of(decoder.drops(), McpDrop::kUnknownOpcode), 1U);
}

TEST(McpBinary, FindsTheNextFrameAfterOneThatEndsEarlyOrLate) {
  for (std::size_t cut = 1; cut < kBinaryReport.size(); ++cut) {
    Bytes stream(kBinaryReport.begin(), kBinaryReport.begin() + static_cast<std::ptrdiff_t>(cut));
    stream.insert(stream.end(), kBinaryReport.begin(), kBinaryReport.end());
    EXPECT_EQ(from_binary(stream), Messages{binary_report()}) << cut;
  }
  Bytes late = kBinaryReport;
  late.insert(late.begin() + 37, 0x55);
  late.insert(late.end(), kBinaryReport.begin(), kBinaryReport.end());
  McpBinaryDecoder decoder;
  EXPECT_EQ(from_binary(late, decoder), Messages{binary_report()});
  EXPECT_EQ(count_of(decoder.drops(), McpDrop::kLostEnd), 1U);
}

/// Random words, as varied as field values can be.
McpReport random_report(std::uint32_t mask, std::mt19937_64& random) {
  McpReport report{.mask = mask};
  for (std::size_t i = 0; i < kMcpFields; ++i) {
    if ((mask >> i & 1U) == 0) continue;
    const auto word = static_cast<std::uint32_t>(random());
    report.fields[i] = is_wide(i) ? word : word & 0xFFFFU;
  }
  if ((mask & 1U) != 0) report.fields[0] = mask;
  return report;
}

/// Random bytes, with a preference for those of the protocol.
Bytes line_noise(std::span<const std::uint8_t> favourites, std::mt19937_64& random) {
  Bytes bytes(random() % 60);
  for (std::uint8_t& byte : bytes) {
    byte = random() % 2 == 0 ? favourites[random() % favourites.size()]
                             : static_cast<std::uint8_t>(random());
  }
  return bytes;
}

template <typename Decoder>
Messages in_pieces(const Bytes& stream, Decoder& decoder, std::mt19937_64& random) {
  Messages messages;
  std::span<const std::uint8_t> rest(stream);
  while (!rest.empty()) {
    const auto piece = rest.first(std::min<std::size_t>(rest.size(), random() % 50));
    decoder.decode(piece, messages);
    rest = rest.subspan(piece.size());
  }
  return messages;
}

/// The reports among `messages` that are also in `sent`, in order; noise may look like a message.
void expect_all(const std::vector<McpReport>& sent, const Messages& messages) {
  std::size_t found = 0;
  for (const McpMessage& message : messages) {
    const auto* const report = std::get_if<McpReport>(&message);
    if (report != nullptr && found < sent.size() && *report == sent[found]) ++found;
  }
  EXPECT_EQ(found, sent.size());
}

TEST(McpNoise, EveryBinaryFrameAmongNoiseIsRead) {
  constexpr std::array<std::uint8_t, 5> kFavourites{0x00, 0x02, 0x03, 0x11, 0x1F};
  std::mt19937_64 random(1);
  for (int run = 0; run < 200; ++run) {
    McpBinaryDecoder decoder;
    std::vector<McpReport> sent;
    Bytes stream;
    for (int i = 0; i < 100; ++i) {
      const Bytes between = line_noise(kFavourites, random);
      stream.insert(stream.end(), between.begin(), between.end());
      sent.push_back(random_report(static_cast<std::uint32_t>(random()) | 1U, random));
      append_binary_frame(binary_payload(sent.back(), McpCommand::kReportMask), stream);
    }
    expect_all(sent, in_pieces(stream, decoder, random));
  }
}

TEST(McpNoise, EveryAsciiReportAmongNoiseIsRead) {
  const Bytes favourites = bytes_of("%PSRCLK0f *\r\n\r\r");
  std::mt19937_64 random(2);
  for (int run = 0; run < 200; ++run) {
    const std::uint32_t mask = static_cast<std::uint32_t>(random()) | 2U;
    McpAsciiDecoder decoder(mask);
    std::vector<McpReport> sent;
    Bytes stream;
    for (int i = 0; i < 30; ++i) {
      const Bytes between = line_noise(favourites, random);
      stream.insert(stream.end(), between.begin(), between.end());
      sent.push_back(random_report(mask, random));
      append_ascii(sent.back(), {.line_end = run % 2 == 0 ? "\r\n" : "\r"}, stream);
    }
    expect_all(sent, in_pieces(stream, decoder, random));
  }
}

}  // namespace
}  // namespace topogeo::devices
