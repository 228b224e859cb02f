#include "topogeo/devices/safety_protocol.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "topogeo/devices/little_endian.hpp"

namespace topogeo::devices {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kSafetyMarker = "MS3 MD";
constexpr std::size_t kLargestDataSet = 65'536;
constexpr std::size_t kPartsAtOnce = 4;
constexpr std::size_t kRememberedSets = 16;
constexpr std::size_t kDataHead = 52;
constexpr std::size_t kStateSize = 16;
constexpr std::size_t kDerivedSize = 24;
constexpr std::size_t kSafetyBeamSize = 4;
constexpr std::size_t kMostSafetyBeams = 8192;
constexpr std::size_t kMostPaths = 24;
constexpr std::size_t kConfigurationSize = 30;
constexpr std::size_t kCola2Before = 8;  // STX and length
constexpr std::size_t kCola2Head = 10;
constexpr std::size_t kLongestCola2 = 65'536;
constexpr std::uint8_t kCola2Stx = 2;

std::uint32_t long_at(Bytes bytes, std::size_t at) {
  return word_at(bytes, at) | static_cast<std::uint32_t>(word_at(bytes, at + 2)) << 16U;
}

void put_long(std::vector<std::uint8_t>& bytes, std::uint32_t value) {
  put_word(bytes, value & 0xFFFFU);
  put_word(bytes, value >> 16U);
}

void put_big(std::vector<std::uint8_t>& bytes, std::uint32_t value, unsigned size) {
  for (unsigned i = size; i > 0; --i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8U * (i - 1U)) & 0xFFU));
  }
}

std::uint32_t big_at(Bytes bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8U | bytes[at + i];
  return value;
}

/// 24 bits.
std::uint32_t paths_at(Bytes bytes, std::size_t at) {
  return word_at(bytes, at) | static_cast<std::uint32_t>(bytes[at + 2]) << 16U;
}

/// The block whose offset and size are at `at` of the header: nothing if the data set lacks it,
/// empty optional if it is outside of the data.
std::optional<Bytes> block(Bytes data, std::size_t at) {
  const std::size_t offset = word_at(data, at);
  const std::size_t size = word_at(data, at + 2);
  if (offset == 0 && size == 0) return Bytes();
  if (offset < kDataHead || offset + size > data.size()) return std::nullopt;
  return data.subspan(offset, size);
}

SafetyState to_state(Bytes bytes) {
  const auto bit = [&bytes](std::size_t at, unsigned number) {
    return (bytes[at] >> number & 1U) != 0;
  };
  SafetyState state;
  state.standby = bit(0, 1);
  state.contamination_warning = bit(0, 2);
  state.contamination_error = bit(0, 3);
  state.reference_contour = bit(0, 4);
  state.manipulated = bit(0, 5);
  state.safe_paths = paths_at(bytes, 1);
  state.other_paths = paths_at(bytes, 4);
  state.application_error = bit(15, 0);
  state.device_error = bit(15, 1);
  return state;
}

bool take_beams(Bytes bytes, SafetyScan& scan) {
  if (bytes.size() < 4) return false;
  const std::size_t count = long_at(bytes, 0);
  if (count == 0 || count > kMostSafetyBeams) return false;
  if (bytes.size() < 4 + count * kSafetyBeamSize) return false;
  scan.beams.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = 4 + i * kSafetyBeamSize;
    scan.beams.push_back({word_at(bytes, at), bytes[at + 3]});
  }
  return true;
}

/// Each path has the size of its bits in bytes, then a bit for each beam.
bool take_intrusions(Bytes bytes, SafetyScan& scan) {
  while (bytes.size() >= 4 && scan.intruding.size() < kMostPaths) {
    const std::size_t size = long_at(bytes, 0);
    if (size > bytes.size() - 4) return false;
    std::size_t beams = 0;
    for (std::size_t i = 0; i < std::min(size * 8, scan.beams.size()); ++i) {
      beams += bytes[4 + i / 8] >> (i % 8) & 1U;
    }
    scan.intruding.push_back(beams);
    bytes = bytes.subspan(4 + size);
  }
  return true;
}

void put_state(std::vector<std::uint8_t>& bytes, const SafetyScan& scan) {
  if (!scan.state) return;
  const SafetyState& state = *scan.state;
  bytes.push_back(static_cast<std::uint8_t>(
      (state.standby ? 2U : 1U) | (state.contamination_warning ? 4U : 0U) |
      (state.contamination_error ? 8U : 0U) | (state.reference_contour ? 16U : 0U) |
      (state.manipulated ? 32U : 0U)));
  for (const std::uint32_t paths : {state.safe_paths, state.other_paths, 0U}) {
    put_word(bytes, paths & 0xFFFFU);
    bytes.push_back(static_cast<std::uint8_t>(paths >> 16U & 0xFFU));
  }
  bytes.insert(bytes.end(), {1, 0, 0, 0, 0});  // monitoring cases
  bytes.push_back(static_cast<std::uint8_t>((state.application_error ? 1U : 0U) |
                                            (state.device_error ? 2U : 0U)));
}

void put_angles(std::vector<std::uint8_t>& bytes, const SafetyScan& scan) {
  put_word(bytes, scan.factor);
  put_word(bytes, static_cast<unsigned>(scan.beams.size()));
  put_word(bytes, scan.scan_time_ms);
  put_word(bytes, 0);
  put_long(bytes, static_cast<std::uint32_t>(scan.first));
  put_long(bytes, static_cast<std::uint32_t>(scan.step));
  put_long(bytes, 0);  // beam interval, which follows from the others
  put_long(bytes, 0);
}

void put_beams(std::vector<std::uint8_t>& bytes, const SafetyScan& scan) {
  put_long(bytes, static_cast<std::uint32_t>(scan.beams.size()));
  for (const SafetyBeam& beam : scan.beams) {
    put_word(bytes, beam.distance);
    bytes.push_back(0);  // remission
    bytes.push_back(beam.status);
  }
}

void put_intrusions(std::vector<std::uint8_t>& bytes, const SafetyScan& scan) {
  const std::size_t size = (scan.beams.size() + 31) / 32 * 4;
  for (const std::size_t beams : scan.intruding) {
    put_long(bytes, static_cast<std::uint32_t>(size));
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t left = beams > 8 * i ? std::min<std::size_t>(beams - 8 * i, 8) : 0;
      bytes.push_back(static_cast<std::uint8_t>((1U << left) - 1U));
    }
  }
}

/// No application data.
void put_nothing(std::vector<std::uint8_t>& /*bytes*/, const SafetyScan& /*scan*/) {}

}  // namespace

std::optional<SafetyScan> safety_scan(Bytes data) {
  if (data.size() < kDataHead) return std::nullopt;
  const auto state = block(data, 32);
  const auto derived = block(data, 36);
  const auto beams = block(data, 40);
  const auto intrusions = block(data, 44);
  if (!state || !derived || !beams || !intrusions) return std::nullopt;
  if (derived->size() < kDerivedSize - 4) return std::nullopt;
  SafetyScan scan;
  scan.serial_number = long_at(data, 4);
  scan.channel = data[12];
  scan.sequence = long_at(data, 16);
  scan.scan = long_at(data, 20);
  scan.time_ms = long_at(data, 28);
  scan.factor = word_at(*derived, 0);
  scan.scan_time_ms = word_at(*derived, 4);
  scan.first = static_cast<std::int32_t>(long_at(*derived, 8));
  scan.step = static_cast<std::int32_t>(long_at(*derived, 12));
  if (!take_beams(*beams, scan) || !take_intrusions(*intrusions, scan)) return std::nullopt;
  if (word_at(*derived, 2) != scan.beams.size()) return std::nullopt;
  if (state->size() >= kStateSize) {
    scan.state = to_state(*state);
  } else if (!state->empty()) {
    return std::nullopt;
  }
  return scan;
}

std::vector<std::uint8_t> safety_data(const SafetyScan& scan) {
  std::vector<std::uint8_t> data{'V', 1, 0, 0};
  put_long(data, scan.serial_number);
  put_long(data, 0);  // of the system plug
  put_long(data, scan.channel);
  put_long(data, scan.sequence);
  put_long(data, scan.scan);
  put_long(data, 0);  // date
  put_long(data, scan.time_ms);
  std::vector<std::uint8_t> blocks;
  for (const auto put : {put_state, put_angles, put_beams, put_intrusions, put_nothing}) {
    const std::size_t start = blocks.size();
    put(blocks, scan);
    const std::size_t size = blocks.size() - start;
    put_word(data, size == 0 ? 0U : static_cast<unsigned>(kDataHead + start));
    put_word(data, static_cast<unsigned>(size));
  }
  data.insert(data.end(), blocks.begin(), blocks.end());
  return data;
}

std::vector<std::vector<std::uint8_t>> safety_datagrams(Bytes data, std::uint32_t identification) {
  std::vector<std::vector<std::uint8_t>> datagrams;
  for (std::size_t at = 0; at < data.size(); at += kSafetyFragment) {
    std::vector<std::uint8_t> datagram(kSafetyMarker.begin(), kSafetyMarker.end());
    put_word(datagram, 1);
    put_long(datagram, static_cast<std::uint32_t>(data.size()));
    put_long(datagram, identification);
    put_long(datagram, static_cast<std::uint32_t>(at));
    put_long(datagram, 0);
    const Bytes fragment = data.subspan(at, std::min(kSafetyFragment, data.size() - at));
    datagram.insert(datagram.end(), fragment.begin(), fragment.end());
    datagrams.push_back(std::move(datagram));
  }
  return datagrams;
}

SafetyAssembler::Part* SafetyAssembler::part_of(std::uint32_t identification, std::size_t size) {
  const auto found = std::ranges::find(parts_, identification, &Part::identification);
  if (found != parts_.end()) {
    if (found->data.size() == size) return &*found;
    ++incomplete_;  // the scanner began anew, or one of both lengths is forged
    parts_.erase(found);
  }
  if (parts_.size() >= kPartsAtOnce) {
    ++incomplete_;
    parts_.pop_front();
  }
  parts_.push_back(
      {identification, std::vector<std::uint8_t>(size), std::vector<bool>(size), size});
  return &parts_.back();
}

std::optional<std::vector<std::uint8_t>> SafetyAssembler::add(Bytes datagram) {
  constexpr std::string_view kMarker = kSafetyMarker.substr(0, 4);
  if (datagram.size() <= kSafetyHead ||
      !std::equal(kMarker.begin(), kMarker.end(), datagram.begin())) {
    ++foreign_;
    return std::nullopt;
  }
  const std::size_t size = long_at(datagram, 8);
  const std::uint32_t identification = long_at(datagram, 12);
  const std::size_t at = long_at(datagram, 16);
  const Bytes fragment = datagram.subspan(kSafetyHead);
  if (size > kLargestDataSet || at > size || fragment.size() > size - at) {
    ++foreign_;
    return std::nullopt;
  }
  if (std::ranges::find(done_, identification) != done_.end()) {
    ++repeated_;
    return std::nullopt;
  }
  Part& part = *part_of(identification, size);
  const auto start = part.here.begin() + static_cast<std::ptrdiff_t>(at);
  const auto end = start + static_cast<std::ptrdiff_t>(fragment.size());
  if (std::find(start, end, true) != end) {
    ++repeated_;
    return std::nullopt;
  }
  std::fill(start, end, true);
  std::ranges::copy(fragment, part.data.begin() + static_cast<std::ptrdiff_t>(at));
  part.missing -= fragment.size();
  if (part.missing > 0) return std::nullopt;
  std::vector<std::uint8_t> data = std::move(part.data);
  std::erase_if(parts_, [&](const Part& other) { return other.identification == identification; });
  done_.push_back(identification);
  if (done_.size() > kRememberedSets) done_.pop_front();
  return data;
}

void SafetyAssembler::clear() {
  parts_.clear();
  done_.clear();
}

std::vector<std::uint8_t> cola2_bytes(const Cola2Telegram& telegram) {
  std::vector<std::uint8_t> bytes(4, kCola2Stx);
  put_big(bytes, static_cast<std::uint32_t>(kCola2Head + telegram.data.size()), 4);
  put_big(bytes, 0, 2);  // hub counter and NoC
  put_big(bytes, telegram.session, 4);
  put_big(bytes, telegram.request, 2);
  bytes.push_back(static_cast<std::uint8_t>(telegram.type));
  bytes.push_back(static_cast<std::uint8_t>(telegram.mode));
  bytes.insert(bytes.end(), telegram.data.begin(), telegram.data.end());
  return bytes;
}

std::vector<std::uint8_t> safety_configuration(const SafetyOutput& output) {
  constexpr unsigned kStateAnglesBeamsFields = 0b1111;
  std::vector<std::uint8_t> data;
  put_word(data, kSafetyConfigure);
  put_long(data, output.channel);
  data.push_back(1);  // enabled
  data.push_back(output.interface);
  put_word(data, 0);
  put_long(data, output.address);
  put_word(data, output.port);
  put_word(data, 1);  // every scan
  put_long(data, 0);  // from the first angle
  put_long(data, 0);  // to the last
  put_word(data, kStateAnglesBeamsFields);
  put_word(data, 0);
  return data;
}

std::optional<SafetyOutput> safety_output(Bytes data) {
  if (data.size() != kConfigurationSize || word_at(data, 0) != kSafetyConfigure) {
    return std::nullopt;
  }
  return SafetyOutput{data[2], data[7], long_at(data, 10), word_at(data, 14)};
}

std::vector<Cola2Telegram> Cola2Reader::read(Bytes bytes) {
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  std::vector<Cola2Telegram> telegrams;
  Bytes rest(buffer_);
  while (!rest.empty()) {
    const std::size_t marks = std::min<std::size_t>(rest.size(), 4);
    const bool begins =
        std::ranges::all_of(rest.first(marks), [](std::uint8_t byte) { return byte == kCola2Stx; });
    if (begins && rest.size() < kCola2Before) break;
    const std::size_t length = begins ? big_at(rest, 4, 4) : 0;
    if (length < kCola2Head || length > kLongestCola2) {
      ++noise_bytes_;
      rest = rest.subspan(1);
      continue;
    }
    if (rest.size() < kCola2Before + length) break;
    const Bytes data = rest.subspan(kCola2Before + kCola2Head, length - kCola2Head);
    telegrams.push_back({big_at(rest, 10, 4),
                         static_cast<std::uint16_t>(big_at(rest, 14, 2)),
                         static_cast<char>(rest[16]),
                         static_cast<char>(rest[17]),
                         {data.begin(), data.end()}});
    rest = rest.subspan(kCola2Before + length);
  }
  buffer_.erase(buffer_.begin(), buffer_.end() - static_cast<std::ptrdiff_t>(rest.size()));
  return telegrams;
}

}  // namespace topogeo::devices
