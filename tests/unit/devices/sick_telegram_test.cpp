#include "topogeo/devices/sick_telegram.hpp"

#include <cstdint>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sick_streams.hpp"

namespace topogeo::devices {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Bytes kOk = hex("02 80 03 00 A0 00 00 06 0A");
const Bytes kAck{kSickAck};
const Bytes kNak{kSickNak};

SickDecoder host() {
  return {SickDecoder::Listener::kHost, kByteGap_ns};
}

std::vector<Bytes> all(const Bytes& stream, std::size_t part = 1000) {
  SickDecoder decoder = host();
  return decode(decoder, stream, part);
}

SickCounters counts(const Bytes& stream) {
  SickDecoder decoder = host();
  decode(decoder, stream, 7);
  return decoder.counters();
}

TEST(SickTelegram, IsWrittenAsPrinted) {
  EXPECT_EQ(sick_command(0x31), hex("02 00 01 00 31 15 12"));
  EXPECT_EQ(sick_command(0x20, hex("24")), hex("02 00 02 00 20 24 34 08"));
  const std::string password = "SICK_PLS";
  Bytes data{0x00};
  data.insert(data.end(), password.begin(), password.end());
  EXPECT_EQ(sick_command(0x20, data), hex("02 00 0A 00 20 00 53 49 43 4B 5F 50 4C 53 CC FC"));
  EXPECT_EQ(sick_reply(0xA0, hex("00"), 0x10, 0x81), hex("02 81 03 00 A0 00 10 36 1A"));
  EXPECT_EQ(sick_reply(0x92, {}, 0), hex("02 80 02 00 92 00 6F 33"));
}

TEST(SickTelegram, OfAScanIsWrittenAsWorkedOutByAScript) {
  std::vector<std::uint16_t> rising(361);
  std::iota(rising.begin(), rising.end(), std::uint16_t{1000});
  const auto check = [](const std::vector<std::uint16_t>& words, std::uint8_t status,
                        const std::string& start, const std::string& end) {
    const Bytes telegram = measured_values(words, status);
    EXPECT_EQ(telegram.size(), words.size() * 2 + 10);
    const Bytes head = hex(start);
    const Bytes tail = hex(end);
    EXPECT_TRUE(std::equal(head.begin(), head.end(), telegram.begin())) << start;
    EXPECT_TRUE(std::equal(tail.rbegin(), tail.rend(), telegram.rbegin())) << end;
  };
  check(rising, 0, "02 80 D6 02 B0 69 01 E8 03 E9 03", "50 05 00 EF 5B");
  check(std::vector<std::uint16_t>(361, 640), 0, "02 80 D6 02 B0 69 01 80 02", "80 02 00 48 3C");
  check(std::vector<std::uint16_t>(361, 0), 0, "02 80 D6 02 B0 69 01 00 00", "00 5B 43");
  check(std::vector<std::uint16_t>(361, 0xFFFF), 0x80, "02 80 D6 02 B0 69 01 FF FF", "80 FE A6");
  check(std::vector<std::uint16_t>(180, 500), 0, "02 80 6C 01 B0 B4 00 F4 01", "F4 01 00 67 29");
}

TEST(SickTelegram, RefusesWhatIsTooLong) {
  EXPECT_NO_THROW((void)sick_command(0x77, Bytes(63)));
  EXPECT_THROW((void)sick_command(0x77, Bytes(64)), std::invalid_argument);
  EXPECT_NO_THROW((void)sick_reply(0xB1, Bytes(810), 0));
  EXPECT_THROW((void)sick_reply(0xB1, Bytes(811), 0), std::invalid_argument);
  EXPECT_THROW((void)sick_reply(0xB1, {}, 0, 0x7F), std::invalid_argument);
}

TEST(SickDecoder, TellsThePartsOfATelegram) {
  SickDecoder decoder = host();
  const Bytes bytes = hex("02 81 07 00 BB 01 B4 00 32 00 10 06 1F");
  decoder.push(bytes, 17);
  const auto event = decoder.next();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, SickEvent::Kind::kTelegram);
  EXPECT_EQ(event->telegram.address, 0x81);
  EXPECT_EQ(event->telegram.code, 0xBB);
  EXPECT_EQ(Bytes(event->telegram.data.begin(), event->telegram.data.end()), hex("01 B4 00 32 00"));
  EXPECT_EQ(event->telegram.status, 0x10);
  EXPECT_EQ(event->telegram.arrived_ns, 17);
  EXPECT_EQ(event->telegram.bytes_since, 0U);
  EXPECT_EQ(event->telegram.size(), bytes.size());
  EXPECT_FALSE(decoder.next());
}

TEST(SickDecoder, KnowsWhenEachTelegramArrived) {
  Bytes stream;
  append(stream, kOk);
  append(stream, kOk);
  stream.push_back(kSickAck);
  SickDecoder decoder = host();
  decoder.push(std::span(stream).first(4), 10);
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.due_ns(), 10 + kByteGap_ns);
  decoder.push(std::span(stream).subspan(4), 20);
  const auto first = decoder.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->telegram.arrived_ns, 20);
  EXPECT_EQ(first->telegram.bytes_since, 10U);
  const auto second = decoder.next();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->telegram.bytes_since, 1U);
  EXPECT_EQ(decoder.next()->kind, SickEvent::Kind::kAck);
  EXPECT_EQ(decoder.due_ns(), std::numeric_limits<std::int64_t>::max());
}

TEST(SickDecoder, FindsATelegramWithFalseStartsInside) {
  const Bytes false_start = hex("02 80 0E 00 B0 05 00 50 02 80 02 23 21 00 48 FF 9F 00 B4 96");
  const Bytes many = measured_values(std::vector<std::uint16_t>(361, 640));
  Bytes stream = false_start;
  append(stream, many);
  for (const std::size_t part : {1U, 3U, 731U, 5000U}) {
    EXPECT_THAT(all(stream, part), ElementsAre(false_start, many)) << part;
  }
  // When listening begins anywhere in the first scan, the second one is still found.
  for (std::size_t from = 1; from < many.size(); from += 5) {
    Bytes late(many.begin() + static_cast<std::ptrdiff_t>(from), many.end());
    append(late, many);
    EXPECT_THAT(all(late), ElementsAre(many)) << from;
  }
}

TEST(SickDecoder, GivesSingleBytesOnlyBetweenTelegrams) {
  Bytes stream{kSickAck};
  append(stream, kOk);
  stream.push_back(kSickNak);
  EXPECT_THAT(all(stream), ElementsAre(kAck, kOk, kNak));
  // Codes of 0615 hexadecimal are not single bytes, nor are they in the rest of a broken scan.
  Bytes scan = measured_values(std::vector<std::uint16_t>(181, 0x0615));
  EXPECT_THAT(all(scan), ElementsAre(scan));
  scan.erase(scan.begin());
  EXPECT_THAT(all(scan), IsEmpty());
  // They count again after a silence.
  SickDecoder decoder = host();
  EXPECT_THAT(decode(decoder, scan, 100), IsEmpty());
  EXPECT_THAT(decode(decoder, Bytes{kSickAck}, 1, kByteGap_ns), ElementsAre(kAck));
}

TEST(SickDecoder, LooksIntoATelegramThatWasCutShort) {
  const Bytes scan = measured_values(std::vector<std::uint16_t>(361, 640));
  for (std::size_t kept = 4; kept < scan.size(); kept += 13) {
    Bytes stream(scan.begin(), scan.begin() + static_cast<std::ptrdiff_t>(kept));
    append(stream, scan);
    append(stream, kOk);
    SickDecoder decoder = host();
    EXPECT_THAT(decode(decoder, stream, 50), ElementsAre(scan, kOk)) << kept;
    SickCounters expected;
    expected.telegrams = 2;
    expected.truncated = 1;
    EXPECT_EQ(decoder.counters(), expected) << kept;
  }
}

TEST(SickDecoder, GivesUpAfterASilence) {
  const Bytes scan = measured_values(std::vector<std::uint16_t>(361, 640));
  SickDecoder decoder = host();
  decoder.push(std::span(scan).first(700), 0);
  EXPECT_FALSE(decoder.next());
  decoder.tick(kByteGap_ns - 1);
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.counters().truncated, 0U);
  decoder.tick(kByteGap_ns);
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.counters().truncated, 1U);
  EXPECT_EQ(decoder.counters().noise_bytes, 0U);
  EXPECT_EQ(decoder.due_ns(), std::numeric_limits<std::int64_t>::max());
  // The rest of the scan is too late to belong to its start.
  EXPECT_THAT(decode(decoder, std::span(scan).subspan(700), 5, 3 * kByteGap_ns), IsEmpty());
}

TEST(SickDecoder, FindsWhatStandsInAFalseTelegramAfterASilence) {
  Bytes stream = hex("02 80 D6 02 B0 69 01");
  append(stream, kOk);
  SickDecoder decoder = host();
  decoder.push(stream, 0);
  EXPECT_FALSE(decoder.next());
  decoder.tick(kByteGap_ns);
  std::vector<Bytes> found;
  drain(decoder, found);
  EXPECT_THAT(found, ElementsAre(kOk));
}

TEST(SickDecoder, CountsWhatItDropsByReason) {
  SickCounters expected;
  expected.noise_bytes = 5;
  EXPECT_EQ(counts(hex("55 00 FF 15 02")), expected) << "noise";
  Bytes bad = kOk;
  bad[5] = 1;
  expected = {};
  expected.bad_crc = 1;
  EXPECT_EQ(counts(bad), expected);
  append(bad, kOk);
  expected.telegrams = 1;
  EXPECT_EQ(counts(bad), expected);
  expected = {};
  expected.implausible_length = 1;
  EXPECT_EQ(counts(hex("02 80 00 10")), expected) << "too long";
  EXPECT_EQ(counts(hex("02 80 01 00")), expected) << "too short";
  expected.noise_bytes = 5;
  EXPECT_EQ(counts(hex("02 80 06 00 B0 02 00 01 00")), expected)
      << "two readings in a place for one";
  expected = {};
  expected.echoes = 1;
  expected.acks = 1;
  expected.telegrams = 1;
  Bytes echo = sick_command(0x31);
  echo.push_back(kSickAck);
  append(echo, kOk);
  EXPECT_EQ(counts(echo), expected);
  EXPECT_THAT(all(echo), ElementsAre(kAck, kOk));
}

TEST(SickDecoder, CountsABrokenScanOnce) {
  const Bytes scan = measured_values(std::vector<std::uint16_t>(361, 640));
  for (std::size_t at = 7; at < scan.size(); at += 11) {
    Bytes stream = scan;
    stream[at] ^= 0x40;
    append(stream, scan);
    SickCounters expected;
    expected.telegrams = 1;
    expected.bad_crc = 1;
    EXPECT_EQ(counts(stream), expected) << at;
  }
}

TEST(SickDecoder, ListensAsASensor) {
  SickDecoder decoder(SickDecoder::Listener::kSensor, kByteGap_ns);
  Bytes stream{kSickAck};
  append(stream, kOk);
  append(stream, sick_command(0x31));
  append(stream, sick_command(0x20, hex("24")));
  EXPECT_THAT(decode(decoder, stream, 4),
              ElementsAre(sick_command(0x31), sick_command(0x20, hex("24"))));
  EXPECT_EQ(decoder.counters().noise_bytes, 1 + kOk.size());
}

TEST(SickDecoder, ForgetsTheBeginningWhenTheLineChanges) {
  SickDecoder decoder = host();
  decoder.push(std::span(kOk).first(6), 0);
  EXPECT_FALSE(decoder.next());
  decoder.clear();
  EXPECT_THAT(decode(decoder, std::span(kOk).subspan(6), 9), IsEmpty());
  EXPECT_THAT(decode(decoder, kOk, 9), ElementsAre(kOk));
  SickCounters expected;
  expected.telegrams = 1;
  expected.noise_bytes = 3;
  EXPECT_EQ(decoder.counters(), expected);
}

}  // namespace
}  // namespace topogeo::devices
