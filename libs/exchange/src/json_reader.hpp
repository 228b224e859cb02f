// Access to JSON documents with known contents: a deviation is an error "FILE:
// features[3].properties.id: expected ..., got ...".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

namespace topogeo::exchange {

class JsonValue {
 public:
  /// `json` must outlive the value.
  JsonValue(const nlohmann::ordered_json* json, std::string where)
      : json_(json), where_(std::move(where)) {}

  [[noreturn]] void fail(const std::string& expected) const;
  [[nodiscard]] bool exists() const { return json_ != nullptr && !json_->is_null(); }
  /// The value of a key, which may be absent; fails if this value is no object.
  [[nodiscard]] JsonValue at(const std::string& key) const;
  /// Fails if the key is absent.
  [[nodiscard]] JsonValue required(const std::string& key) const;
  /// The items of an array.
  [[nodiscard]] std::vector<JsonValue> items() const;

  [[nodiscard]] std::string text() const;
  /// The text, or `otherwise` if there is no value.
  [[nodiscard]] std::string text_or(const std::string& otherwise) const;
  [[nodiscard]] bool boolean_or(bool otherwise) const;
  /// Finite and within 1,000 km: no coordinate or speed is larger.
  [[nodiscard]] double number() const;
  [[nodiscard]] double number_or(double otherwise) const;
  [[nodiscard]] double number_between(double least, double most, std::string_view unit) const;
  /// A whole number, also written as 1.0.
  [[nodiscard]] std::uint32_t id() const;
  [[nodiscard]] std::uint64_t whole() const;
  [[nodiscard]] std::vector<double> numbers() const;
  /// Finite, however large.
  [[nodiscard]] double any_number() const;
  [[nodiscard]] bool is_text() const { return exists() && json_->is_string(); }
  [[nodiscard]] bool is_number() const { return exists() && json_->is_number(); }
  [[nodiscard]] bool is_object() const { return exists() && json_->is_object(); }
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  const nlohmann::ordered_json* json_;  // null: absent
  std::string where_;
};

/// Throws std::runtime_error naming the file and the byte at which it is not JSON, or the exceeded
/// limit of json_limits.hpp.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& name);

/// The text of a file, with a line for each entry of the lists on the top two levels of `json`, so
/// that people and `diff` can read it.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace topogeo::exchange
