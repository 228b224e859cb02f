#include "topogeo/devices/port_recognizer.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/rplidar_protocol.hpp"

namespace topogeo::devices {
namespace {

/// Packets in a row that no other device sends by chance.
constexpr std::size_t kEnoughPackets = 8;
/// Reports of ten a second, which a search hears for half a second at most rates.
constexpr std::size_t kEnoughReports = 3;
/// The rate of the measurements tells an STL-19P from an LD19: the mean of 4,500 and 5,000 a
/// second.
constexpr double kStl19p_hz = 4750.0;
constexpr std::size_t kRateNeeds = 40;
constexpr std::uint32_t kLd08Baud = 115'200;
constexpr std::uint32_t kFastBaud = 230'400;
/// Samples of a standard scan in a row; three bits of each are a check.
constexpr std::size_t kEnoughSamples = 40;
constexpr std::int64_t kSickByteGap_ns = 50'000'000;

/// Measurements a second of successive packets.
double samples_hz(std::span<const LdPacket> packets) {
  const unsigned wrap = kLdTimeWrap_ms;
  const unsigned passed_ms = (wrap + packets.back().time_ms - packets.front().time_ms) % wrap;
  const auto points = static_cast<double>((packets.size() - 1) * kLdPoints);
  return passed_ms == 0 ? 0.0 : 1000.0 * points / passed_ms;
}

/// Models of a maker by the rate of their line.
struct ModelAtRate {
  std::uint32_t baud;
  std::string_view model;
};
constexpr std::array<ModelAtRate, 4> kYdModels{{{115'200, "ydlidar_x2"},
                                                {128'000, "ydlidar_x4"},
                                                {230'400, "ydlidar_g4"},
                                                {512'000, "ydlidar_tg"}}};
constexpr std::array<ModelAtRate, 4> kRpModels{{{115'200, "rplidar_a2"},
                                                {256'000, "rplidar_a3"},
                                                {460'800, "rplidar_c1"},
                                                {1'000'000, "rplidar_s2"}}};

template <std::size_t N>
std::string_view model_at(const std::array<ModelAtRate, N>& models, std::uint32_t baud) {
  const auto* const model = std::ranges::find(models, baud, &ModelAtRate::baud);
  return model == models.end() ? std::string_view() : model->model;
}

/// The upper four bits of the number that a RPLIDAR reports are its series.
std::string_view rplidar_model(std::uint32_t baud, std::uint8_t number) {
  constexpr unsigned kFirstOfA2 = 0x20;
  constexpr unsigned kFirstOfS = 0x60;
  if (baud == kLd08Baud && number < kFirstOfA2) return "rplidar_a1";
  if (baud == 256'000 && number >= kFirstOfS) return "rplidar_s1";
  return model_at(kRpModels, baud);
}

/// Sweeps of the lasers in the table, as their driver asks for them.
constexpr unsigned kStepsOfUrg = 768;
constexpr std::array<ScipScanRequest, 4> kScipSweeps{{{ScipScanKind::kThreeCharacters, 44, 725},
                                                      {ScipScanKind::kTwoCharacters, 44, 725},
                                                      {ScipScanKind::kThreeCharacters, 0, 1080},
                                                      {ScipScanKind::kIntensities, 0, 1080}}};

std::string_view scip_model(std::string_view product) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kProducts{
      {{"UTM", "utm_30lx"}, {"UST-10", "ust_10lx"}, {"UST", "ust_20lx"}}};
  for (const auto& [name, model] : kProducts) {
    if (product.find(name) != std::string_view::npos) return model;
  }
  return "urg_04lx";
}

std::string_view cola_model(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kNames{
      {{"TiM55", "sick_tim551"},
       {"TiM7", "sick_tim7xx"},
       {"TiM", "sick_tim5xx"},
       {"LMS1", "sick_lms1xx"},
       {"LMS5", "sick_lms5xx"},
       {"LRS4", "sick_lrs4xxx"}}};
  for (const auto& [part, model] : kNames) {
    if (name.find(part) != std::string_view::npos) return model;
  }
  return {};
}

std::string_view cola_model(std::size_t beams) {
  constexpr std::array<std::pair<std::size_t, std::string_view>, 5> kBeams{
      {{271, "sick_tim551"},
       {811, "sick_tim5xx"},
       {541, "sick_lms1xx"},
       {381, "sick_lms5xx"},
       {1500, "sick_lrs4xxx"}}};
  for (const auto& [count, model] : kBeams) {
    if (count == beams) return model;
  }
  return {};
}

bool are_samples(std::span<const std::uint8_t> bytes) {
  for (std::size_t at = 0; at < bytes.size(); at += kRpSample_bytes) {
    if (!rp_sample(bytes.subspan(at, kRpSample_bytes))) return false;
  }
  return true;
}

/// Two packets of an express or dense scan, one behind the other.
bool are_packets(std::span<const std::uint8_t> bytes) {
  return std::ranges::any_of(std::array{rp_answer::kExpress, rp_answer::kDense}, [&](auto type) {
    return rp_packet(bytes.first(kRpPacket_bytes), type) &&
           rp_packet(bytes.subspan(kRpPacket_bytes, kRpPacket_bytes), type);
  });
}

}  // namespace

PortRecognizer::PortRecognizer(const LineSettings& line, Question asked)
    : line_(line), asked_(asked), sick_(SickDecoder::Listener::kHost, kSickByteGap_ns) {}

RecognizedDevice PortRecognizer::laser(std::string_view model) const {
  return {DeviceKind::kLaser, model, line_};
}

PortRecognizer::Found PortRecognizer::receive(std::span<const std::uint8_t> bytes,
                                              std::int64_t now_ns) {
  if (bytes.empty()) return std::nullopt;
  Found found = base_line(bytes);
  if (!found) found = create_frames(bytes);
  if (!found) found = kobuki_frames(bytes);
  if (!found) found = pioneer_packets(bytes);
  if (!found) found = ldrobot_packets(bytes);
  if (!found) found = lds_packets(bytes);
  if (!found) found = ydlidar_packets(bytes);
  if (!found && asked_ == Question::kRpLidarInfo) found = rplidar_answer(bytes);
  if (!found) found = rplidar_samples(bytes);
  if (!found) found = sick_telegram(bytes, now_ns);
  if (!found) found = scip_answer(bytes);
  if (!found) found = cola_answer(bytes);
  return found;
}

PortRecognizer::Found PortRecognizer::base_line(std::span<const std::uint8_t> bytes) {
  for (const std::string& body : text_.read(bytes)) {
    const std::optional<TextBaseMessage> message = text_base_message(body);
    if (!message || (!message->hello && !message->report)) continue;
    RecognizedDevice base{DeviceKind::kBase, "microcontroller", line_};
    if (message->hello) base.device = message->hello->name;
    return base;
  }
  return std::nullopt;
}

/// A Create whose last program was killed still sends the stream of our driver, and may move.
PortRecognizer::Found PortRecognizer::create_frames(std::span<const std::uint8_t> bytes) {
  create_.push(bytes);
  while (create_.next()) ++create_frames_;
  if (create_frames_ < static_cast<int>(kEnoughPackets)) return std::nullopt;
  return RecognizedDevice{DeviceKind::kBase, "create2", line_};
}

PortRecognizer::Found PortRecognizer::kobuki_frames(std::span<const std::uint8_t> bytes) {
  kobuki_.push(bytes);
  while (kobuki_.next()) ++kobuki_frames_;
  if (kobuki_frames_ < static_cast<int>(kEnoughPackets)) return std::nullopt;
  return RecognizedDevice{DeviceKind::kBase, "kobuki", line_};
}

/// A Pioneer whose last program was killed still reports.
PortRecognizer::Found PortRecognizer::pioneer_packets(std::span<const std::uint8_t> bytes) {
  pioneer_.push(bytes);
  while (const auto packet = pioneer_.next()) {
    if (pioneer_report(*packet)) ++pioneer_reports_;
  }
  if (pioneer_reports_ < static_cast<int>(kEnoughReports)) return std::nullopt;
  return RecognizedDevice{DeviceKind::kBase, "pioneer", line_};
}

PortRecognizer::Found PortRecognizer::ldrobot_packets(std::span<const std::uint8_t> bytes) {
  ldrobot_.push(bytes);
  while (const auto found = ldrobot_.next()) ld_packets_.push_back(found->packet);
  if (line_.baud == kLd08Baud && ld_packets_.size() >= kEnoughPackets) return laser("ld08");
  if (line_.baud != kFastBaud || ld_packets_.size() < kRateNeeds) return std::nullopt;
  if (samples_hz(ld_packets_) > kStl19p_hz) return laser("stl19p");
  RecognizedDevice ld19 = laser("ld19");
  ld19.note = "an ld06 sends the same";
  return ld19;
}

PortRecognizer::Found PortRecognizer::lds_packets(std::span<const std::uint8_t> bytes) {
  constexpr auto kEnough = static_cast<int>(kEnoughPackets);
  if (line_.baud == kLd08Baud) {
    xv11_.push(bytes);
    while (xv11_.next()) ++xv11_packets_;
  } else if (line_.baud == kFastBaud) {
    lds01_.push(bytes);
    while (lds01_.next()) ++lds01_packets_;
  }
  if (xv11_packets_ >= kEnough) return laser("xv11");
  if (lds01_packets_ >= kEnough) return laser("lds01");
  return std::nullopt;
}

PortRecognizer::Found PortRecognizer::ydlidar_packets(std::span<const std::uint8_t> bytes) {
  const std::string_view model = model_at(kYdModels, line_.baud);
  if (model.empty()) return std::nullopt;
  ydlidar_.push(bytes);
  while (const auto found = ydlidar_.next()) {
    if (found->packet) {
      ++yd_packets_;
    } else if (asked_ == Question::kYdLidarInfo && found->answer_type == yd_answer::kInfo) {
      RecognizedDevice named = laser(model);
      named.device = text_of(rp_info(found->answer));
      return named;
    }
  }
  if (yd_packets_ < static_cast<int>(kEnoughPackets)) return std::nullopt;
  return laser(model);
}

/// A laser whose last program was killed still sends its scan.
PortRecognizer::Found PortRecognizer::rplidar_samples(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kWindow_bytes =
      std::max(2 * kRpPacket_bytes, kEnoughSamples * kRpSample_bytes);
  const std::string_view model = model_at(kRpModels, line_.baud);
  if (model.empty()) return std::nullopt;
  rp_bytes_.insert(rp_bytes_.end(), bytes.begin(), bytes.end());
  for (; rp_bytes_.size() >= kWindow_bytes; rp_bytes_.pop_front()) {
    const std::vector<std::uint8_t> window(rp_bytes_.begin(), rp_bytes_.begin() + kWindow_bytes);
    if (!are_samples(window) && !are_packets(window)) continue;
    RecognizedDevice sending = laser(model);
    if (line_.baud == kLd08Baud) sending.note = "or a rplidar_a1: it does not answer now";
    if (line_.baud == 256'000) sending.note = "or a rplidar_s1: it does not answer now";
    return sending;
  }
  return std::nullopt;
}

PortRecognizer::Found PortRecognizer::rplidar_answer(std::span<const std::uint8_t> bytes) {
  rplidar_.push(bytes);
  while (const auto answer = rplidar_.next()) {
    if (answer->descriptor.type != rp_answer::kInfo || answer->data.size() != kRpInfo_bytes) {
      continue;
    }
    const RpInfo info = rp_info(answer->data);
    RecognizedDevice named = laser(rplidar_model(line_.baud, info.model));
    named.device = text_of(info);
    return named;
  }
  return std::nullopt;
}

PortRecognizer::Found PortRecognizer::sick_telegram(std::span<const std::uint8_t> bytes,
                                                    std::int64_t now_ns) {
  sick_.push(bytes, now_ns);
  while (const auto event = sick_.next()) {
    if (event->kind != SickEvent::Kind::kTelegram) continue;
    const auto status = pls_status_report(event->telegram);
    if (!status && !pls_measured_values(event->telegram)) continue;
    RecognizedDevice sick = laser("sick_pls");
    if (status) sick.device = status->software;
    return sick;
  }
  return std::nullopt;
}

/// Answers to VV, and scans that a laser still sends.
PortRecognizer::Found PortRecognizer::scip_answer(std::span<const std::uint8_t> bytes) {
  for (const std::string& text : scip_.read(bytes)) {
    if (const auto fields = scip_fields(text, "VV")) {
      const std::string_view product = scip_field(*fields, "PROD");
      RecognizedDevice hokuyo = laser(scip_model(product));
      hokuyo.device =
          std::string(product) + ", firmware " + std::string(scip_field(*fields, "FIRM"));
      return hokuyo;
    }
    for (const ScipScanRequest& request : kScipSweeps) {
      const auto answer = devices::scip_answer(text, scip_command(request));
      if (!answer || answer->status != "99" || !scip_scan(*answer, request)) continue;
      RecognizedDevice hokuyo = laser(request.last_step > kStepsOfUrg ? "utm_30lx" : "urg_04lx");
      if (request.last_step > kStepsOfUrg)
        hokuyo.note = "or a ust_10lx or ust_20lx: it does not answer now";
      return hokuyo;
    }
  }
  return std::nullopt;
}

/// Answers to "sRN DeviceIdent", and scans that a laser still sends.
PortRecognizer::Found PortRecognizer::cola_answer(std::span<const std::uint8_t> bytes) {
  for (const ColaTelegram& telegram : cola_.read(bytes)) {
    std::string name;
    std::string_view model;
    if (telegram.name == "sRA DeviceIdent") {
      ColaFields fields(telegram);
      name = fields.sized_text();
      model = cola_model(name);
      name += ", firmware " + fields.sized_text();
    } else if (const auto scan = cola_scan(telegram)) {
      model = cola_model(scan->ranges_m.size());
    }
    if (model.empty()) continue;
    RecognizedDevice sick = laser(model);
    sick.device = name;
    if (name.empty()) sick.note = "by the number of its beams";
    return sick;
  }
  return std::nullopt;
}

}  // namespace topogeo::devices
