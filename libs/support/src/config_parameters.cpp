// Declarations of parameters: parsing, checking and printing of each type.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <type_traits>

#include "topogeo/support/config_schema.hpp"

namespace topogeo::support {
namespace {

/// Doubles: the shortest text that reads back to the same value.
template <typename Number>
std::string number_text(Number value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  if (text.starts_with('+') || text.empty()) return std::nullopt;
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string rows_text(const NumberRows& rows) {
  std::ostringstream text;
  const char* before_row = "";
  for (const std::vector<double>& row : rows) {
    const char* before = before_row;
    for (const double number : row) {
      text << before << number_text(number);
      before = " ";
    }
    before_row = "; ";
  }
  return text.str();
}

std::optional<std::vector<double>> parse_row(const std::string& text) {
  std::vector<double> row;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const auto number = parse_number<double>(word);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    row.push_back(*number);
  }
  if (row.empty()) return std::nullopt;
  return row;
}

std::optional<NumberRows> parse_rows(const std::string& text) {
  NumberRows rows;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = text.find(';', begin);
    auto row = parse_row(text.substr(begin, end - begin));
    if (!row) return std::nullopt;
    rows.push_back(std::move(*row));
  }
  return rows;
}

bool is_well_formed(std::string_view key) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.';
  };
  return !key.empty() && key.front() != '.' && key.back() != '.' &&
         key.find("..") == std::string_view::npos && std::ranges::all_of(key, allowed);
}

[[noreturn]] void refuse_text(std::string_view key, const std::string& value,
                              const std::string& expected) {
  throw std::invalid_argument("key '" + std::string(key) + "' = '" + value + "': expected " +
                              expected);
}

std::string interval_text(double low, double high, const std::string& unit) {
  return "between " + number_text(low) + " and " + number_text(high) +
         (unit.empty() ? "" : " " + unit);
}

}  // namespace

void refuse_value(std::string_view key, double value, const std::string& expected) {
  refuse_text(key, number_text(value), expected);
}

void require_between(std::string_view key, double value, double low, double high,
                     const std::string& unit) {
  // Written so that a NaN, which is neither above nor below, is refused.
  if (value >= low && value <= high) return;
  refuse_value(key, value, "number " + interval_text(low, high, unit));
}

void require_at_least(std::string_view key, double value, std::string_view low_key, double low) {
  if (value >= low) return;
  refuse_value(key, value, "at least " + std::string(low_key) + " = " + number_text(low));
}

const ConfigParameter* ConfigSchema::find(std::string_view key) const {
  const auto found =
      std::ranges::find_if(parameters_, [&](const ConfigParameter& p) { return p.key == key; });
  return found == parameters_.end() ? nullptr : &*found;
}

bool ConfigSchema::is_section(std::string_view path) const {
  const std::string prefix = std::string(path) + ".";
  return std::ranges::any_of(parameters_,
                             [&](const ConfigParameter& p) { return p.key.starts_with(prefix); });
}

void ConfigSchema::refuse_section(const std::string& section, const std::string& reason) {
  if (is_section(section) || find(section) != nullptr) {
    throw std::invalid_argument("configuration key '" + section + "': declared, cannot be refused");
  }
  refused_[section] = reason;
}

const std::string* ConfigSchema::refusal(std::string_view section) const {
  const auto at = refused_.find(section);
  return at == refused_.end() ? nullptr : &at->second;
}

void ConfigSchema::fix(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    const auto p = std::ranges::find(parameters_, key, &ConfigParameter::key);
    if (p == parameters_.end()) {
      throw std::invalid_argument("configuration key '" + std::string(key) + "': not declared");
    }
    p->fixed = true;
    p->expected = p->default_text + ", because it is fixed and no longer a setting";
    p->parse = [parse = std::move(p->parse), text = p->text, value = p->default_text](
                   const std::string& given) -> std::optional<std::function<void()>> {
      const auto assign = parse(given);
      if (!assign) return std::nullopt;
      (*assign)();
      const bool same = text() == value;
      (*parse(value))();
      if (!same) return std::nullopt;
      return [] {};
    };
  }
}

void ConfigSchema::leave_out_of_fingerprint(std::string_view section) {
  const std::string prefix = std::string(section) + ".";
  for (ConfigParameter& p : parameters_) {
    if (p.key.starts_with(prefix)) p.in_fingerprint = false;
  }
}

void ConfigSchema::insert(ConfigParameter parameter) {
  const std::string& key = parameter.key;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("configuration key '" + key + "': " + why);
  };
  if (!is_well_formed(key)) refuse("expected letters, digits, '_' and single '.' between");
  if (find(key) != nullptr) refuse("declared twice");
  if (is_section(key)) refuse("is already a section");
  for (std::size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', dot + 1)) {
    if (find(key.substr(0, dot)) != nullptr) refuse("its section is already a parameter");
  }
  parameter.default_text = parameter.text();
  if (!parameter.parse(parameter.default_text)) {
    refuse_text(key, parameter.default_text, parameter.expected);
  }
  parameters_.push_back(std::move(parameter));
}

template <typename Number>
void ConfigSchema::add_number(std::string key, Number* value, Number min, Number max,
                              std::string unit, std::string why, std::string_view kind) {
  ConfigParameter p;
  p.expected = std::string(kind) + " between " + number_text(min) + " and " + number_text(max) +
               (unit.empty() ? "" : " " + unit);
  p.key = std::move(key);
  p.unit = std::move(unit);
  p.why = std::move(why);
  p.text = [value] { return number_text(*value); };
  p.parse = [value, min, max](const std::string& text) -> std::optional<std::function<void()>> {
    const auto parsed = parse_number<Number>(text);
    // Written so that a NaN, which is neither above nor below, is refused.
    if (!parsed || !(*parsed >= min && *parsed <= max)) return std::nullopt;
    return [value, number = *parsed] { *value = number; };
  };
  insert(std::move(p));
}

void ConfigSchema::add(std::string key, double* value, double min, double max, std::string unit,
                       std::string why) {
  add_number(std::move(key), value, min, max, std::move(unit), std::move(why), "number");
}

void ConfigSchema::add(std::string key, std::int32_t* value, std::int32_t min, std::int32_t max,
                       std::string unit, std::string why) {
  add_number(std::move(key), value, min, max, std::move(unit), std::move(why), "whole number");
}

void ConfigSchema::add(std::string key, std::uint32_t* value, std::uint32_t min, std::uint32_t max,
                       std::string unit, std::string why) {
  add_number(std::move(key), value, min, max, std::move(unit), std::move(why), "whole number");
}

void ConfigSchema::add(std::string key, std::uint64_t* value, std::uint64_t min, std::uint64_t max,
                       std::string unit, std::string why) {
  add_number(std::move(key), value, min, max, std::move(unit), std::move(why), "whole number");
}

void ConfigSchema::add(std::string key, bool* value, std::string why) {
  ConfigParameter p;
  p.key = std::move(key);
  p.why = std::move(why);
  p.expected = "true or false";
  p.text = [value] { return *value ? "true" : "false"; };
  p.parse = [value](const std::string& text) -> std::optional<std::function<void()>> {
    if (text != "true" && text != "false") return std::nullopt;
    return [value, parsed = text == "true"] { *value = parsed; };
  };
  insert(std::move(p));
}

void ConfigSchema::add(std::string key, std::string* value, std::string why) {
  ConfigParameter p;
  p.key = std::move(key);
  p.why = std::move(why);
  p.expected = "text";
  p.is_text = true;
  p.text = [value] { return *value; };
  p.parse = [value](const std::string& text) -> std::optional<std::function<void()>> {
    return [value, text] { *value = text; };
  };
  insert(std::move(p));
}

void ConfigSchema::add_number_rows(std::string key, std::function<NumberRows()> get,
                                   std::function<std::optional<Assignment>(const NumberRows&)> set,
                                   std::string expected, std::string why) {
  ConfigParameter p;
  p.key = std::move(key);
  p.why = std::move(why);
  p.expected = std::move(expected);
  p.is_text = true;
  p.is_rows = true;
  p.text = [get = std::move(get)] { return rows_text(get()); };
  p.parse = [set = std::move(set)](const std::string& text) -> std::optional<Assignment> {
    if (text.find_first_not_of(" \t") == std::string::npos) return set({});
    const auto rows = parse_rows(text);
    return rows ? set(*rows) : std::nullopt;
  };
  insert(std::move(p));
}

void ConfigSchema::add_enumeration(std::string key, const std::vector<std::string>& names,
                                   std::function<std::size_t()> get,
                                   std::function<void(std::size_t)> set, std::string why) {
  ConfigParameter p;
  p.key = std::move(key);
  p.why = std::move(why);
  p.expected = "one of";
  for (std::size_t i = 0; i < names.size(); ++i) p.expected += (i == 0 ? " " : ", ") + names[i];
  p.text = [get = std::move(get), names] {
    const std::size_t i = get();
    return i < names.size() ? names[i] : std::string();
  };
  p.parse = [set = std::move(set),
             names](const std::string& text) -> std::optional<std::function<void()>> {
    const auto found = std::ranges::find(names, text);
    if (found == names.end()) return std::nullopt;
    return [set, index = static_cast<std::size_t>(found - names.begin())] { set(index); };
  };
  insert(std::move(p));
}

}  // namespace topogeo::support
