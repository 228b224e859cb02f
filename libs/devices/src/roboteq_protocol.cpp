#include "topogeo/devices/roboteq_protocol.hpp"

#include <charconv>
#include <utility>

namespace topogeo::devices {
namespace {

constexpr std::size_t kLongestRoboteqLine = 80;
constexpr std::size_t kLongestRoboteqName = 5;
constexpr std::string_view kOrderKinds = "!?^~";

bool is_capital(char c) {
  return c >= 'A' && c <= 'Z';
}

/// Numbers separated by `separator`; empty if one of them is none.
std::optional<std::vector<std::int32_t>> roboteq_numbers(std::string_view text, char separator) {
  std::vector<std::int32_t> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    std::int32_t number = 0;
    const auto [behind, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return std::nullopt;
    numbers.push_back(number);
    if (behind == end) return numbers;
    if (*behind != separator) return std::nullopt;
    at = behind + 1;
  }
}

std::size_t capitals(std::string_view text) {
  std::size_t count = 0;
  while (count < text.size() && is_capital(text[count])) ++count;
  return count;
}

std::optional<RoboteqAnswer> roboteq_answer(std::string_view line) {
  const std::size_t name = capitals(line);
  if (name == 0 || name > kLongestRoboteqName || name == line.size()) return std::nullopt;
  if (line[name] != '=') return std::nullopt;
  const auto numbers = roboteq_numbers(line.substr(name + 1), ':');
  if (!numbers) return std::nullopt;
  return RoboteqAnswer{std::string(line.substr(0, name)), *numbers};
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const RoboteqAnswer& answer) {
  std::string line = answer.name;
  char before = '=';
  for (const std::int32_t number : answer.numbers) {
    line += std::exchange(before, ':') + std::to_string(number);
  }
  line += '\r';
  return {line.begin(), line.end()};
}

void RoboteqDecoder::push(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    const auto c = static_cast<char>(byte);
    if (c == '\r') {
      take_line();
    } else if (c != '\n' && !long_) {
      line_ += c;
      long_ = line_.size() > kLongestRoboteqLine;
      if (long_) ++counters_.long_lines;
    }
  }
}

void RoboteqDecoder::take_line() {
  const std::string line = std::exchange(line_, {});
  if (std::exchange(long_, false) || line.empty()) return;
  if (line == "+" || line == "-" || kOrderKinds.find(line.front()) != std::string_view::npos) {
    return;
  }
  if (auto answer = roboteq_answer(line)) {
    answers_.push_back(*std::move(answer));
  } else {
    ++counters_.bad_lines;
  }
}

std::optional<RoboteqAnswer> RoboteqDecoder::next() {
  if (answers_.empty()) return std::nullopt;
  std::optional<RoboteqAnswer> answer(std::move(answers_.front()));
  answers_.pop_front();
  return answer;
}

void RoboteqDecoder::clear() {
  line_.clear();
  answers_.clear();
  long_ = false;
}

std::string roboteq_line(const RoboteqOrder& order) {
  std::string line = order.kind + order.name;
  for (const std::int32_t argument : order.arguments) line += " " + std::to_string(argument);
  return line + "\r";
}

std::optional<RoboteqOrder> roboteq_order(std::string_view line) {
  if (line.empty() || kOrderKinds.find(line.front()) == std::string_view::npos) return std::nullopt;
  const std::size_t name = capitals(line.substr(1));
  if (name == 0) return std::nullopt;
  RoboteqOrder order{line.front(), std::string(line.substr(1, name))};
  const std::string_view rest = line.substr(1 + name);
  if (rest.empty()) return order;
  if (rest.front() != ' ') return std::nullopt;
  auto arguments = roboteq_numbers(rest.substr(1), ' ');
  if (!arguments) return std::nullopt;
  order.arguments = *std::move(arguments);
  return order;
}

}  // namespace topogeo::devices
