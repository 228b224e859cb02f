#include "topogeo/devices/scip_protocol.hpp"

#include <algorithm>
#include <charconv>

namespace topogeo::devices {
namespace {

constexpr unsigned kScipBits = 6;
constexpr unsigned kScipMask = 0x3F;
constexpr unsigned char kScipZero = 0x30;
/// Characters of a line of data, besides its sum.
constexpr std::size_t kScipLine = 64;
constexpr std::size_t kScipTime = 4;
/// Longer than any answer.
constexpr std::size_t kScipLongest_bytes = 32'768;
/// Lasers of this protocol have up to 1,440 steps.
constexpr unsigned kMostSteps = 8192;

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The lines below the last echo; empty without one.
std::optional<std::vector<std::string_view>> lines_below(std::string_view text,
                                                         std::string_view echo) {
  const std::string head = std::string(echo) + '\n';
  const std::size_t at = text.rfind(head);
  if (at == std::string_view::npos) return std::nullopt;
  std::vector<std::string_view> lines = lines_of(text.substr(at + head.size()));
  if (lines.empty()) return std::nullopt;
  return lines;
}

/// The line without its sum; empty if the sum is wrong.
std::optional<std::string_view> checked_line(std::string_view line) {
  if (line.size() < 2) return std::nullopt;
  const std::string_view body = line.substr(0, line.size() - 1);
  if (scip_sum(body) != line.back()) return std::nullopt;
  return body;
}

std::optional<unsigned> number(std::string_view text) {
  unsigned value = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || at != end) return std::nullopt;
  return value;
}

std::string digits(unsigned value, std::size_t count) {
  std::string text = std::to_string(value);
  text.insert(0, count - std::min(count, text.size()), '0');
  return text;
}

std::size_t characters_of(ScipScanKind kind) {
  return kind == ScipScanKind::kTwoCharacters ? 2 : 3;
}

}  // namespace

char scip_sum(std::string_view text) {
  unsigned sum = 0;
  for (const char character : text) sum += static_cast<unsigned char>(character);
  return static_cast<char>((sum & kScipMask) + kScipZero);
}

std::string scip_encode(std::uint32_t value, std::size_t characters) {
  std::string text(characters, '0');
  for (auto place = text.rbegin(); place != text.rend(); ++place) {
    *place = static_cast<char>((value & kScipMask) + kScipZero);
    value >>= kScipBits;
  }
  return text;
}

std::optional<std::uint32_t> scip_decode(std::string_view text) {
  if (text.size() > kScipTime) return std::nullopt;
  std::uint32_t value = 0;
  for (const char character : text) {
    const unsigned code = static_cast<unsigned char>(character) - unsigned{kScipZero};
    if (code > kScipMask) return std::nullopt;
    value = value << kScipBits | code;
  }
  return value;
}

std::optional<ScipAnswer> scip_answer(std::string_view text, std::string_view echo) {
  const auto lines = lines_below(text, echo);
  if (!lines) return std::nullopt;
  ScipAnswer answer;
  for (const std::string_view line : *lines) {
    const auto body = checked_line(line);
    if (!body) return std::nullopt;
    answer.lines.emplace_back(*body);
  }
  answer.status = answer.lines.front();
  answer.lines.erase(answer.lines.begin());
  if (answer.status.size() != 2) return std::nullopt;
  return answer;
}

std::string scip_text(std::string_view echo, const ScipAnswer& answer) {
  std::string text(echo);
  text += '\n' + answer.status + scip_sum(answer.status) + '\n';
  for (const std::string& line : answer.lines) text += line + scip_sum(line) + '\n';
  return text + '\n';
}

std::string scip_text_of_fields(std::string_view echo, const ScipAnswer& answer) {
  std::string text(echo);
  text += '\n' + answer.status + scip_sum(answer.status) + '\n';
  for (const std::string& line : answer.lines) text += line + ';' + scip_sum(line) + '\n';
  return text + '\n';
}

std::optional<ScipFields> scip_fields(std::string_view text, std::string_view echo) {
  const auto lines = lines_below(text, echo);
  if (!lines || checked_line(lines->front()) != "00") return std::nullopt;
  ScipFields fields;
  for (std::size_t i = 1; i < lines->size(); ++i) {
    const std::string_view line = (*lines)[i];
    if (line.size() < 2 || line[line.size() - 2] != ';') return std::nullopt;
    const std::string_view body = line.substr(0, line.size() - 2);
    const std::size_t colon = body.find(':');
    if (scip_sum(body) != line.back() || colon == std::string_view::npos) return std::nullopt;
    fields.emplace_back(body.substr(0, colon), body.substr(colon + 1));
  }
  return fields;
}

std::string_view scip_field(const ScipFields& fields, std::string_view name) {
  const auto field = std::ranges::find(fields, name, &ScipFields::value_type::first);
  return field == fields.end() ? std::string_view() : std::string_view(field->second);
}

std::optional<ScipParameters> scip_parameters(const ScipFields& fields) {
  ScipParameters found;
  found.model = scip_field(fields, "MODL");
  const std::pair<const char*, unsigned*> numbers[] = {
      {"DMIN", &found.range_min_mm}, {"DMAX", &found.range_max_mm}, {"ARES", &found.steps_of_turn},
      {"AMIN", &found.first_step},   {"AMAX", &found.last_step},    {"AFRT", &found.front_step},
      {"SCAN", &found.rpm}};
  for (const auto& [name, value] : numbers) {
    const auto read = number(scip_field(fields, name));
    if (!read) return std::nullopt;
    *value = *read;
  }
  const bool possible = found.first_step < found.last_step &&
                        found.last_step - found.first_step < found.steps_of_turn &&
                        found.steps_of_turn <= kMostSteps && found.front_step <= kMostSteps &&
                        found.range_min_mm < found.range_max_mm && found.rpm > 0;
  if (!possible) return std::nullopt;
  return found;
}

ScipFields scip_fields_of(const ScipParameters& parameters) {
  return {{"MODL", parameters.model},
          {"DMIN", std::to_string(parameters.range_min_mm)},
          {"DMAX", std::to_string(parameters.range_max_mm)},
          {"ARES", std::to_string(parameters.steps_of_turn)},
          {"AMIN", std::to_string(parameters.first_step)},
          {"AMAX", std::to_string(parameters.last_step)},
          {"AFRT", std::to_string(parameters.front_step)},
          {"SCAN", std::to_string(parameters.rpm)}};
}

std::string scip_command(const ScipScanRequest& request) {
  std::string command = "MD";
  if (request.kind == ScipScanKind::kTwoCharacters) command = "MS";
  if (request.kind == ScipScanKind::kIntensities) command = "ME";
  command += digits(request.first_step, 4) + digits(request.last_step, 4);
  return command + "00" + "0" + "00";  // no steps together, each scan, without end
}

std::optional<ScipScan> scip_scan(const ScipAnswer& answer, const ScipScanRequest& request) {
  if (answer.lines.empty() || answer.lines.front().size() != kScipTime) return std::nullopt;
  const auto time_ms = scip_decode(answer.lines.front());
  std::string data;
  for (std::size_t i = 1; i < answer.lines.size(); ++i) {
    const bool last = i + 1 == answer.lines.size();
    if (!last && answer.lines[i].size() != kScipLine) return std::nullopt;
    data += answer.lines[i];
  }
  const std::size_t size = characters_of(request.kind);
  const bool both = request.kind == ScipScanKind::kIntensities;
  const std::size_t beams = request.last_step - request.first_step + 1;
  if (!time_ms || data.size() != beams * size * (both ? 2 : 1)) return std::nullopt;
  ScipScan scan;
  scan.time_ms = *time_ms;
  for (std::size_t at = 0; at < data.size(); at += size) {
    const auto value = scip_decode(std::string_view(data).substr(at, size));
    if (!value) return std::nullopt;
    const bool intensity = both && (at / size) % 2 == 1;
    (intensity ? scan.intensities : scan.distances_mm).push_back(*value);
  }
  return scan;
}

ScipAnswer scip_answer_of(const ScipScan& scan, const ScipScanRequest& request) {
  const std::size_t size = characters_of(request.kind);
  std::string data;
  for (std::size_t i = 0; i < scan.distances_mm.size(); ++i) {
    data += scip_encode(scan.distances_mm[i], size);
    if (request.kind == ScipScanKind::kIntensities) data += scip_encode(scan.intensities[i], size);
  }
  ScipAnswer answer{"99", {scip_encode(scan.time_ms, kScipTime)}};
  for (std::size_t at = 0; at < data.size(); at += kScipLine) {
    answer.lines.push_back(data.substr(at, kScipLine));
  }
  return answer;
}

std::optional<std::uint32_t> scip_time_ms(const ScipAnswer& answer) {
  if (answer.status != "00" || answer.lines.size() != 1) return std::nullopt;
  return answer.lines.front().size() == kScipTime ? scip_decode(answer.lines.front())
                                                  : std::nullopt;
}

std::vector<std::string> ScipReader::read(std::span<const std::uint8_t> bytes) {
  std::vector<std::string> texts;
  for (const std::uint8_t byte : bytes) {
    text_ += static_cast<char>(byte);
    if (text_.ends_with("\n\n")) {
      text_.resize(text_.size() - 1);
      if (text_.size() > 1) texts.push_back(text_);
      text_.clear();
    } else if (text_.size() > kScipLongest_bytes) {
      noise_bytes_ += text_.size();
      text_.clear();
    }
  }
  return texts;
}

}  // namespace topogeo::devices
