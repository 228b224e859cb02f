// Typed configuration: every parameter is declared once, with key, variable, range, unit and
// reason.
//
// The declaration is the basis for checking files and configurations in memory, listing the values
// in force, and generating the example file and the table of the documentation. The default of a
// parameter is the value of its variable at the declaration. Each library declares its own
// configuration structs in `describe(Config&, ConfigSchema&)` beside them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace topogeo::support {

/// Numbers by rows, as in a matrix; rows may differ in length.
using NumberRows = std::vector<std::vector<double>>;

/// One declared parameter.
struct ConfigParameter {
  std::string key;       ///< "section.name", any depth
  std::string unit;      ///< "" without a unit
  std::string why;       ///< its effect, and reasons to change it
  std::string expected;  ///< "number between 0.1 and 5 m", for messages and the example file
  std::string default_text;
  bool is_text = false;  ///< strings: quoted in YAML
  bool is_rows = false;  ///< a list of lists of numbers in YAML, or its text
  bool in_fingerprint = true;
  bool fixed = false;  ///< no setting: checked in memory and accepted in files that repeat it

  std::function<std::string()> text;  ///< current value; doubles in the shortest form that reads
                                      ///< back to the same value
  /// Parses a text and returns the function that stores its value; empty for an invalid text or a
  /// value out of range.
  std::function<std::optional<std::function<void()>>(const std::string&)> parse;
};

class ConfigSchema {
 public:
  // Each declares a parameter. `key` consists of letters, digits, '_' and '.'; `value` must outlive
  // the schema. Throw std::invalid_argument naming the key if it is malformed, declared twice or
  // also a section, and "key 'KEY' = 'VALUE': expected ..." if the value is out of range.
  void add(std::string key, double* value, double min, double max, std::string unit,
           std::string why);
  void add(std::string key, std::int32_t* value, std::int32_t min, std::int32_t max,
           std::string unit, std::string why);
  void add(std::string key, std::uint32_t* value, std::uint32_t min, std::uint32_t max,
           std::string unit, std::string why);
  void add(std::string key, std::uint64_t* value, std::uint64_t min, std::uint64_t max,
           std::string unit, std::string why);
  void add(std::string key, bool* value, std::string why);
  void add(std::string key, std::string* value, std::string why);

  /// An enumeration by names: add("match.form", &form, {{"combined", Form::kCombined}, ...},
  /// "...").
  template <typename Enum>
  void add(const std::string& key, Enum* value,
           const std::vector<std::pair<std::string, Enum>>& names, const std::string& why);

  /// A matrix or a list of tuples, written by rows: "0.9 0.1; 0.1 0.9", in YAML also as [[0.9,
  /// 0.1], [0.1, 0.9]]. `value_of` returns nothing for rows of another form, or for no rows where
  /// the value must not be empty; `expected` describes the form.
  template <typename Value>
  void add_rows(const std::string& key, Value* value, NumberRows (*rows_of)(const Value&),
                std::optional<Value> (*value_of)(const NumberRows&), const std::string& expected,
                const std::string& why);

  /// Turns declared parameters into constants: a file may only repeat their values, as files
  /// written by earlier versions do, and no list or documentation shows them. Their ranges are
  /// still checked in memory, and fingerprints still contain them. Throws std::invalid_argument for
  /// a key that is not declared.
  void fix(std::initializer_list<std::string_view> keys);

  /// Refuses files that contain the section, with the error "key 'SECTION' `reason`". Throws
  /// std::invalid_argument if it is declared.
  void refuse_section(const std::string& section, const std::string& reason);

  /// Why a section is refused; null if it is not.
  [[nodiscard]] const std::string* refusal(std::string_view section) const;

  /// Excludes the keys of a section that no result depends on: configurations that differ only in
  /// these have the same fingerprint.
  void leave_out_of_fingerprint(std::string_view section);

  /// Settings and fixed parameters, in the order of declaration.
  [[nodiscard]] const std::vector<ConfigParameter>& parameters() const { return parameters_; }

  /// The parameter, or null.
  [[nodiscard]] const ConfigParameter* find(std::string_view key) const;

  /// Whether a declared key starts with "path.".
  [[nodiscard]] bool is_section(std::string_view path) const;

 private:
  void add_enumeration(std::string key, const std::vector<std::string>& names,
                       std::function<std::size_t()> get, std::function<void(std::size_t)> set,
                       std::string why);
  using Assignment = std::function<void()>;
  void add_number_rows(std::string key, std::function<NumberRows()> get,
                       std::function<std::optional<Assignment>(const NumberRows&)> set,
                       std::string expected, std::string why);
  template <typename Number>
  void add_number(std::string key, Number* value, Number min, Number max, std::string unit,
                  std::string why, std::string_view kind);
  void insert(ConfigParameter parameter);

  std::vector<ConfigParameter> parameters_;
  std::map<std::string, std::string, std::less<>> refused_;  // reason by section
};

/// Checks every value of a configuration against its declared range, by its library's `void
/// describe(Config&, ConfigSchema&)`. Throws std::invalid_argument "key 'KEY' = 'VALUE': expected
/// number between a and b UNIT". Takes some microseconds per parameter: for constructors, not for
/// calls with every scan.
template <typename Config>
void check_ranges(Config config) {
  ConfigSchema schema;
  describe(config, schema);
}

/// The same exception for inconsistent values, which no single range excludes.
[[noreturn]] void refuse_value(std::string_view key, double value, const std::string& expected);

/// Throws as refuse_value unless low <= value <= high: for a limit that depends on another value.
void require_between(std::string_view key, double value, double low, double high,
                     const std::string& unit);

/// Throws as refuse_value unless value >= low, the value of another key.
void require_at_least(std::string_view key, double value, std::string_view low_key, double low);

/// Markdown tables of all parameters, one per section: key, default, range with unit, reason.
void write_markdown(const ConfigSchema& schema, std::ostream& out);

/// Reads a YAML file of nested sections (or dotted keys) into the declared variables; keys missing
/// in the file keep their value. Throws std::runtime_error "FILE:LINE: key 'x.y' = 'v': expected
/// number between a and b m", or another cause (unknown or repeated key, wrong type, broken YAML,
/// unreadable file); then no variable is changed.
void load_yaml_file(const std::filesystem::path& path, const ConfigSchema& schema);

/// The same for YAML text; `name` replaces the file in messages.
void load_yaml_text(std::string_view text, const std::string& name, const ConfigSchema& schema);

/// The values in force.
struct EffectiveConfig {
  /// (key, value) of each setting, in the order of declaration.
  std::vector<std::pair<std::string, std::string>> values;
  std::uint64_t fingerprint = 0;  ///< 64-bit FNV-1a of the values that results depend on
};
EffectiveConfig effective(const ConfigSchema& schema);

/// A documented YAML file with the current values, which load_yaml_file reads back exactly.
/// Comments above each key state its default, range, unit and reason.
void write_yaml(const ConfigSchema& schema, std::ostream& out);

template <typename Enum>
void ConfigSchema::add(const std::string& key, Enum* value,
                       const std::vector<std::pair<std::string, Enum>>& names,
                       const std::string& why) {
  std::vector<std::string> texts;
  std::vector<Enum> values;
  for (const auto& [text, meaning] : names) {
    texts.push_back(text);
    values.push_back(meaning);
  }
  auto get = [value, values] {
    std::size_t i = 0;
    while (i < values.size() && values[i] != *value) ++i;
    return i;
  };
  auto set = [value, values](std::size_t i) { *value = values[i]; };
  add_enumeration(key, texts, std::move(get), std::move(set), why);
}

template <typename Value>
void ConfigSchema::add_rows(const std::string& key, Value* value,
                            NumberRows (*rows_of)(const Value&),
                            std::optional<Value> (*value_of)(const NumberRows&),
                            const std::string& expected, const std::string& why) {
  auto set = [value, value_of](const NumberRows& rows) -> std::optional<Assignment> {
    auto parsed = value_of(rows);
    if (!parsed) return std::nullopt;
    return [value, parsed = std::move(*parsed)] { *value = parsed; };
  };
  add_number_rows(
      key, [value, rows_of] { return rows_of(*value); }, std::move(set), expected, why);
}

}  // namespace topogeo::support
