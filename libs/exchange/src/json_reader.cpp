#include "json_reader.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "topogeo/support/format.hpp"
#include "topogeo/support/json_limits.hpp"

namespace topogeo::exchange {
namespace {

// A larger number is damaged, as in drawings.
constexpr double kMost = 1e6;

std::string shown(const nlohmann::ordered_json* json) {
  if (json == nullptr) return "nothing";
  constexpr std::size_t kMostShown = 40;
  std::string text = json->dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (text.size() > kMostShown) text = text.substr(0, kMostShown) + "...";
  return text;
}

void append_lines(const nlohmann::ordered_json& json, int depth, std::string& text) {
  const auto dumped = [](const nlohmann::ordered_json& value) {
    return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  };
  if (depth == 0 || json.empty() || !(json.is_array() || json.is_object())) {
    text += dumped(json);
    return;
  }
  const char* separator = "\n";
  text += json.is_array() ? '[' : '{';
  for (const auto& [key, value] : json.items()) {
    text += separator;
    if (json.is_object()) text += dumped(key) + ':';
    const bool opens = value.is_array() || json.is_array();
    append_lines(value, opens ? depth - 1 : depth, text);
    separator = ",\n";
  }
  text += json.is_array() ? "\n]" : "\n}";
}

}  // namespace

void JsonValue::fail(const std::string& expected) const {
  throw std::runtime_error(fmt::format("{}: expected {}, got {}", where_, expected, shown(json_)));
}

JsonValue JsonValue::at(const std::string& key) const {
  if (json_ == nullptr || !json_->is_object()) fail("an object");
  const auto found = json_->find(key);
  const bool top = where_.ends_with(':');
  return {found == json_->end() ? nullptr : &*found, where_ + (top ? " " : ".") + key};
}

JsonValue JsonValue::required(const std::string& key) const {
  JsonValue value = at(key);
  if (!value.exists()) value.fail("a value");
  return value;
}

std::vector<JsonValue> JsonValue::items() const {
  if (json_ == nullptr || !json_->is_array()) fail("an array");
  std::vector<JsonValue> values;
  values.reserve(json_->size());
  for (const nlohmann::ordered_json& item : *json_) {
    values.emplace_back(&item, fmt::format("{}[{}]", where_, values.size()));
  }
  return values;
}

std::string JsonValue::text() const {
  if (!is_text()) fail("a text");
  return json_->get<std::string>();
}

std::string JsonValue::text_or(const std::string& otherwise) const {
  return exists() ? text() : otherwise;
}

bool JsonValue::boolean_or(bool otherwise) const {
  if (!exists()) return otherwise;
  if (!json_->is_boolean()) fail("true or false");
  return json_->get<bool>();
}

double JsonValue::number() const {
  const double value = any_number();
  if (std::fabs(value) > kMost) fail("a number from -1e6 to 1e6");
  return value;
}

double JsonValue::any_number() const {
  if (!exists() || !json_->is_number()) fail("a number");
  const double value = json_->get<double>();
  if (!std::isfinite(value)) fail("a finite number");
  return value;
}

double JsonValue::number_between(double least, double most, std::string_view unit) const {
  const double value = any_number();
  if (value < least || value > most) fail(fmt::format("{:g} to {:g} {}", least, most, unit));
  return value;
}

double JsonValue::number_or(double otherwise) const {
  return exists() ? number() : otherwise;
}

std::uint32_t JsonValue::id() const {
  constexpr double kMostId = std::numeric_limits<std::uint32_t>::max();
  const double value = exists() && json_->is_number() ? json_->get<double>() : -1.0;
  if (!(value >= 0.0 && value <= kMostId && value == std::floor(value))) {
    fail("a whole number from 0 to 4294967295");
  }
  return static_cast<std::uint32_t>(value);
}

std::uint64_t JsonValue::whole() const {
  if (!exists() || !json_->is_number_unsigned()) fail("a whole number of 0 or more");
  return json_->get<std::uint64_t>();
}

std::vector<double> JsonValue::numbers() const {
  std::vector<double> values;
  for (const JsonValue& item : items()) values.push_back(item.number());
  return values;
}

nlohmann::ordered_json parse_json(std::string_view text, const std::string& name) {
  if (const std::string excess = support::beyond_limits(text); !excess.empty()) {
    throw std::runtime_error(name + ": " + excess);
  }
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::ordered_json::parse_error& error) {
    throw std::runtime_error(
        fmt::format("{}: expected JSON, invalid at byte {}", name, error.byte));
  }
}

std::string json_text(const nlohmann::ordered_json& json) {
  std::string text;
  append_lines(json, 1, text);
  return text + '\n';
}

}  // namespace topogeo::exchange
