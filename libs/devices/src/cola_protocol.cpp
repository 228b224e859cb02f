#include "topogeo/devices/cola_protocol.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>

namespace topogeo::devices {
namespace {

constexpr std::uint8_t kColaStx = 0x02;
constexpr std::uint8_t kColaEtx = 0x03;
constexpr std::size_t kColaMarks = 4;
constexpr std::size_t kColaHeader = 8;
constexpr int kHexadecimal = 16;
/// The longest scan: 1,081 values in each of a few channels.
constexpr std::size_t kColaLongest_bytes = 16'384;
constexpr std::size_t kNameOfChannel = 5;
constexpr std::uint32_t kMostColaBeams = 2048;
constexpr std::uint32_t kMostChannels = 8;
constexpr double kColaDegree = 1e-4;
/// Smaller numbers are reasons for no return.
constexpr std::uint32_t kFirstColaDistance = 16;
constexpr double kColaMm = 0.001;

std::uint8_t cola_sum(const std::vector<std::uint8_t>& bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum ^= byte;
  return sum;
}

void append_word(std::string& bytes, std::uint32_t value, std::size_t size) {
  for (std::size_t i = size; i-- > 0;) bytes += static_cast<char>(value >> (8 * i) & 0xFFU);
}

/// Name and fields of the bytes between the marks; a name is two words.
ColaTelegram split(ColaDialect dialect, std::string_view body) {
  const std::size_t kind_end = std::min(body.find(' '), body.size());
  const std::size_t name_end = std::min(body.find(' ', kind_end + 1), body.size());
  ColaTelegram telegram{dialect, std::string(body.substr(0, name_end)), {}};
  if (name_end < body.size()) telegram.fields = body.substr(name_end + 1);
  return telegram;
}

struct ColaChannel {
  std::string name;
  double scale = 0.0;
  double offset = 0.0;
  double first_deg = 0.0;
  double step_deg = 0.0;
  std::vector<std::uint32_t> values;
};

ColaChannel read_channel(ColaFields& fields) {
  ColaChannel channel;
  channel.name = fields.text(kNameOfChannel);
  channel.scale = fields.real();
  channel.offset = fields.real();
  channel.first_deg = kColaDegree * static_cast<std::int32_t>(fields.number(4));
  channel.step_deg = kColaDegree * fields.number(2);
  const std::uint32_t count = fields.number(2);
  if (count > kMostColaBeams) return {};
  for (std::uint32_t i = 0; i < count; ++i) channel.values.push_back(fields.number(2));
  return channel;
}

/// The number of channels of 8 bits, then marks whether position, name, comment, time and event
/// follow. Fields behind a mark are not read.
bool has_tail(ColaFields& fields) {
  constexpr int kMarks = 5;
  const std::uint32_t channels = fields.number(2);
  if (channels > 0) return fields.ok() && channels <= kMostChannels;
  for (int i = 0; i < kMarks; ++i) {
    const std::uint32_t mark = fields.number(2);
    if (!fields.ok() || mark > 1) return false;
    if (mark == 1) return true;
  }
  return true;
}

bool plausible(const ColaChannel& channel) {
  constexpr double kTurn_deg = 360.0;
  const auto gaps = static_cast<double>(channel.values.size()) - 1.0;
  return channel.values.size() > 1 && channel.step_deg > 0.0 &&
         gaps * channel.step_deg < kTurn_deg && std::fabs(channel.first_deg) <= kTurn_deg &&
         channel.scale > 0.0 && channel.scale <= 100.0 && std::fabs(channel.offset) <= 1e6;
}

}  // namespace

std::vector<std::uint8_t> cola_bytes(const ColaTelegram& telegram) {
  std::string body = telegram.name;
  if (!telegram.fields.empty()) body += ' ' + telegram.fields;
  std::string text;
  if (telegram.dialect == ColaDialect::kText) {
    text = static_cast<char>(kColaStx) + body + static_cast<char>(kColaEtx);
  } else {
    text.assign(kColaMarks, static_cast<char>(kColaStx));
    append_word(text, static_cast<std::uint32_t>(body.size()), 4);
    text += body;
    text += static_cast<char>(cola_sum({body.begin(), body.end()}));
  }
  return {text.begin(), text.end()};
}

std::string_view ColaFields::take(std::size_t size) {
  if (!ok_ || rest_.size() < size) {
    ok_ = false;
    return {};
  }
  const std::string_view part = rest_.substr(0, size);
  rest_.remove_prefix(size);
  return part;
}

std::string_view ColaFields::word() {
  const std::size_t end = std::min(rest_.find(' '), rest_.size());
  const std::string_view part = take(end);
  if (!rest_.empty()) rest_.remove_prefix(1);
  ok_ = ok_ && !part.empty();
  return part;
}

std::uint32_t ColaFields::number(std::size_t bytes) {
  if (dialect_ == ColaDialect::kBinary) {
    std::uint32_t value = 0;
    for (const char byte : take(bytes)) value = value << 8U | static_cast<unsigned char>(byte);
    return value;
  }
  const std::string_view text = word();
  std::uint32_t value = 0;
  // With a sign the number is decimal.
  const bool is_signed = text.starts_with('+') || text.starts_with('-');
  const char* const from = text.data() + (is_signed ? 1 : 0);
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(from, end, value, is_signed ? 10 : kHexadecimal);
  const bool fits = bytes >= 4 || value < 1U << (8 * bytes);
  ok_ = ok_ && error == std::errc() && at == end && fits;
  if (!ok_) return 0;
  return text.starts_with('-') ? 0U - value : value;
}

float ColaFields::real() {
  return std::bit_cast<float>(number(4));
}

std::string ColaFields::text(std::size_t size) {
  return std::string(dialect_ == ColaDialect::kBinary ? take(size) : word());
}

std::string ColaFields::sized_text() {
  const std::uint32_t size = number(2);
  std::string text(take(size));
  if (dialect_ == ColaDialect::kText && !rest_.empty()) rest_.remove_prefix(1);
  return text;
}

void ColaWriter::word(const std::string& text) {
  if (!fields_.empty()) fields_ += ' ';
  fields_ += text;
}

ColaWriter& ColaWriter::number(std::uint32_t value, std::size_t bytes) {
  if (dialect_ == ColaDialect::kBinary) {
    append_word(fields_, value, bytes);
    return *this;
  }
  std::string digits(8, '0');
  const auto [end, error] =
      std::to_chars(digits.data(), digits.data() + digits.size(), value, kHexadecimal);
  digits.resize(static_cast<std::size_t>(end - digits.data()));
  for (char& digit : digits) {
    if (digit >= 'a') digit = static_cast<char>(digit - 'a' + 'A');
  }
  word(digits);
  return *this;
}

ColaWriter& ColaWriter::real(float value) {
  return number(std::bit_cast<std::uint32_t>(value), 4);
}

ColaWriter& ColaWriter::text(std::string_view value) {
  if (dialect_ == ColaDialect::kBinary) {
    fields_ += value;
  } else {
    word(std::string(value));
  }
  return *this;
}

ColaWriter& ColaWriter::sized_text(std::string_view value) {
  return number(static_cast<std::uint32_t>(value.size()), 2).text(value);
}

std::optional<ColaScan> cola_scan(const ColaTelegram& telegram) {
  if (telegram.name != kColaScanName) return std::nullopt;
  ColaFields fields(telegram);
  ColaScan scan;
  static_cast<void>(fields.number(2));  // version
  static_cast<void>(fields.number(2));  // device
  static_cast<void>(fields.number(4));  // serial number
  static_cast<void>(fields.number(1));
  scan.status = static_cast<std::uint8_t>(fields.number(1));
  static_cast<void>(fields.number(2));  // telegrams
  scan.scan_counter = static_cast<std::uint16_t>(fields.number(2));
  scan.start_us = fields.number(4);
  scan.sent_us = fields.number(4);
  for (int i = 0; i < 4; ++i) static_cast<void>(fields.number(1));  // inputs, outputs
  static_cast<void>(fields.number(2));                              // layer
  scan.turns_hz = 0.01 * fields.number(4);
  static_cast<void>(fields.number(4));  // measurements
  const std::uint32_t encoders = fields.number(2);
  if (encoders > kMostChannels) return std::nullopt;
  for (std::uint32_t i = 0; i < encoders; ++i) {
    static_cast<void>(fields.number(4));
    static_cast<void>(fields.number(2));
  }
  const std::uint32_t channels = fields.number(2);
  if (channels > kMostChannels) return std::nullopt;
  for (std::uint32_t i = 0; i < channels && fields.ok(); ++i) {
    const ColaChannel channel = read_channel(fields);
    if (channel.name != "DIST1") continue;
    if (!fields.ok() || !plausible(channel)) return std::nullopt;
    scan.first_deg = channel.first_deg;
    scan.step_deg = channel.step_deg;
    scan.ranges_m.clear();
    for (const std::uint32_t value : channel.values) {
      const double range_m = kColaMm * (channel.scale * value + channel.offset);
      const bool none = value < kFirstColaDistance || range_m < 0.0;
      scan.ranges_m.push_back(none ? 0.0F : static_cast<float>(range_m));
    }
  }
  if (!has_tail(fields) || scan.ranges_m.empty()) return std::nullopt;
  return scan;
}

ColaTelegram cola_telegram(const ColaScan& scan, ColaDialect dialect) {
  constexpr float kOne = 1.0F;
  ColaWriter writer(dialect);
  writer.number(1, 2).number(1, 2).number(0x89A27F, 4);
  writer.number(0, 1).number(scan.status, 1);
  writer.number(scan.scan_counter, 2).number(scan.scan_counter, 2);
  writer.number(scan.start_us, 4).number(scan.sent_us, 4);
  for (int i = 0; i < 4; ++i) writer.number(0, 1);
  writer.number(0, 2);
  writer.number(static_cast<std::uint32_t>(std::lround(100.0 * scan.turns_hz)), 4);
  writer.number(0x36, 4).number(0, 2).number(1, 2);
  writer.text("DIST1").real(kOne).real(0.0F);
  writer.number(static_cast<std::uint32_t>(std::lround(scan.first_deg / kColaDegree)), 4);
  writer.number(static_cast<std::uint32_t>(std::lround(scan.step_deg / kColaDegree)), 2);
  writer.number(static_cast<std::uint32_t>(scan.ranges_m.size()), 2);
  for (const float range_m : scan.ranges_m) {
    writer.number(static_cast<std::uint32_t>(std::lround(range_m / kColaMm)), 2);
  }
  for (int i = 0; i < 6; ++i) writer.number(0, 2);  // no more channels, position, name, ..., events
  return writer.telegram(std::string(kColaScanName));
}

ColaReader::Need ColaReader::take(std::size_t at, ColaTelegram& telegram, std::size_t& size) {
  const auto rest = std::span<const std::uint8_t>(buffer_).subspan(at);
  if (rest.front() != kColaStx) return Need::kNoise;
  if (rest.size() < 2) return Need::kMore;
  if (rest[1] != kColaStx) {  // text
    const auto end = std::ranges::find(rest, kColaEtx);
    const auto again = std::find(rest.begin() + 1, rest.end(), kColaStx);
    if (again < end) return Need::kNoise;
    if (end == rest.end()) return rest.size() > kColaLongest_bytes ? Need::kNoise : Need::kMore;
    const std::string body(rest.begin() + 1, end);
    telegram = split(ColaDialect::kText, body);
    size = body.size() + 2;
    return body.starts_with('s') ? Need::kFound : Need::kNoise;
  }
  if (rest.size() < kColaHeader) return Need::kMore;
  for (std::size_t i = 0; i < kColaMarks; ++i) {
    if (rest[i] != kColaStx) return Need::kNoise;
  }
  std::size_t length = 0;
  for (std::size_t i = kColaMarks; i < kColaHeader; ++i) length = length << 8U | rest[i];
  if (length == 0 || length > kColaLongest_bytes) return Need::kNoise;
  if (rest.size() < kColaHeader + length + 1) return Need::kMore;
  const auto body = rest.subspan(kColaHeader, length);
  const auto behind = rest.subspan(kColaHeader + length + 1);
  const bool follows = behind.empty() || behind.front() == kColaStx;
  if (cola_sum({body.begin(), body.end()}) != rest[kColaHeader + length] || body.front() != 's' ||
      !follows) {
    ++bad_checksum_;
    return Need::kNoise;
  }
  telegram = split(ColaDialect::kBinary, std::string(body.begin(), body.end()));
  size = kColaHeader + length + 1;
  return Need::kFound;
}

std::vector<ColaTelegram> ColaReader::read(std::span<const std::uint8_t> bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  std::vector<ColaTelegram> telegrams;
  std::size_t at = 0;
  while (at < buffer_.size()) {
    ColaTelegram telegram;
    std::size_t size = 1;
    const Need need = take(at, telegram, size);
    if (need == Need::kMore) break;
    if (need == Need::kFound) {
      telegrams.push_back(std::move(telegram));
      at += size;
    } else {
      ++noise_bytes_;
      ++at;
    }
  }
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(at));
  return telegrams;
}

}  // namespace topogeo::devices
