// Reading and writing of configuration files.
#include "topogeo/support/config_schema.hpp"

#include <algorithm>
#include <ostream>
#include <set>
#include <stdexcept>

#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/hash.hpp"
#include "topogeo/support/printable.hpp"
#include "topogeo/support/yaml_reader.hpp"

namespace topogeo::support {
namespace {

// Thirty times the size of a file with every key and comment: a larger one is another kind of file.
constexpr std::size_t kMaxFileSize = 1U << 20U;

/// Text for a one-line message: short, without control characters.
std::string shown(const std::string& text) {
  constexpr std::size_t kMaxLength = 60;
  return printable(text.size() > kMaxLength ? text.substr(0, kMaxLength) + "..." : text);
}

class SchemaReader {
 public:
  explicit SchemaReader(const ConfigSchema& schema) : schema_(schema) {}

  void read(const YamlNode& root) {
    if (root.is_null()) return;  // only comments
    if (!root.is_map()) root.fail_with("expected sections of 'key: value' lines");
    read_section(root, "");
  }

  /// Stores all values; called once the whole file is valid.
  void apply() const {
    for (const auto& assign : assignments_) assign();
  }

 private:
  void read_section(const YamlNode& section, const std::string& path) {
    for (const auto& [key_node, value] : section.entries()) {
      if (!key_node.is_scalar()) key_node.fail_with("expected a plain word as key");
      const std::string key = path.empty() ? key_node.text() : path + "." + key_node.text();
      // The schema is finite, so this also ends a YAML alias that contains itself.
      const ConfigParameter* parameter = schema_.find(key);
      const bool is_section = schema_.is_section(key);
      const std::string quoted = "key '" + shown(key) + "'";
      if (parameter == nullptr && !is_section) {
        const std::string* const refusal = schema_.refusal(key);
        key_node.fail_with(quoted + (refusal ? " " + *refusal : ": " + known_keys(path)));
      }
      if (!seen_.insert(key).second) key_node.fail_with(quoted + ": given twice");
      if (parameter != nullptr) {
        read_value(key_node, value, *parameter);
      } else if (value.is_map()) {
        read_section(value, key);
      } else if (!value.is_null()) {  // a section whose keys are all comments is empty, not wrong
        key_node.fail_with(quoted + ": is a section, expected 'key: value' lines below it");
      }
    }
  }

  void read_value(const YamlNode& key_node, const YamlNode& value,
                  const ConfigParameter& parameter) {
    const std::string quoted = "key '" + parameter.key + "'";
    const std::string expected = ": expected " + parameter.expected;
    // A missing value has the position of the next token.
    if (value.is_null()) key_node.fail_with(quoted + " without a value" + expected);
    const std::optional<std::string> rows = parameter.is_rows ? rows_of(value) : std::nullopt;
    if (!value.is_scalar() && !rows) {
      value.fail_with(quoted + " with a list or section" + expected);
    }
    const bool is_quoted = !rows && value.is_quoted();
    const std::string text = rows ? *rows : value.text();
    auto assign = is_quoted && !parameter.is_text ? std::nullopt : parameter.parse(text);
    if (!assign) {
      const std::string mark = is_quoted ? "\"" : "'";
      value.fail_with(quoted + " = " + mark + shown(text) + mark + expected);
    }
    assignments_.push_back(std::move(*assign));
  }

  /// The text of a list of lists: "0.9 0.1; 0.1 0.9"; nothing for another value.
  static std::optional<std::string> rows_of(const YamlNode& list) {
    if (!list.is_list()) return std::nullopt;
    std::string text;
    for (const YamlNode& row : list.items()) {
      if (!row.is_list()) return std::nullopt;
      if (!text.empty()) text += "; ";
      for (const YamlNode& number : row.items()) {
        if (!number.is_scalar()) return std::nullopt;
        text += number.text() + ' ';
      }
    }
    return text;
  }

  [[nodiscard]] std::string known_keys(const std::string& path) const {
    const std::string prefix = path.empty() ? "" : path + ".";
    std::vector<std::string> names;
    for (const ConfigParameter& p : schema_.parameters()) {
      if (p.fixed || !p.key.starts_with(prefix)) continue;
      const std::string rest = p.key.substr(prefix.size());
      const std::string child = rest.substr(0, rest.find('.'));
      if (std::ranges::find(names, child) == names.end()) names.push_back(child);
    }
    std::string text = "unknown, expected one of";
    for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? " " : ", ") + names[i];
    return text;
  }

  const ConfigSchema& schema_;
  std::set<std::string> seen_;
  std::vector<std::function<void()>> assignments_;
};

std::string quoted_yaml(const std::string& text) {
  static constexpr std::string_view kHex = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (is_control(c)) {
      out += "\\x";
      out += kHex[byte >> 4U];
      out += kHex[byte & 0xfU];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

class YamlWriter {
 public:
  YamlWriter(const ConfigSchema& schema, std::ostream& out) : schema_(schema), out_(out) {}

  /// Writes all keys below `prefix` ("" or "section."); a section is placed where its first key was
  /// declared.
  void write_section(const std::string& prefix, int depth) {
    std::set<std::string> done;
    for (const ConfigParameter& p : schema_.parameters()) {
      if (p.fixed || !p.key.starts_with(prefix)) continue;
      const std::string rest = p.key.substr(prefix.size());
      const std::string name = rest.substr(0, rest.find('.'));
      if (name == rest) {
        write_parameter(p, name, std::string(static_cast<std::size_t>(depth) * 2, ' '));
      } else if (done.insert(name).second) {
        if (depth == 0 && !first_) out_ << '\n';
        out_ << std::string(static_cast<std::size_t>(depth) * 2, ' ') << name << ":\n";
        first_ = false;
        write_section(prefix + name + ".", depth + 1);
      }
    }
  }

 private:
  void write_parameter(const ConfigParameter& p, const std::string& name,
                       const std::string& indent) {
    out_ << indent << "# ";
    for (const char c : p.why) {
      out_ << c;
      if (c == '\n') out_ << indent << "# ";
    }
    const auto yaml_text = [&](const std::string& text) {
      return p.is_text ? quoted_yaml(text) : text;
    };
    out_ << '\n' << indent << "# " << p.expected << "; default " << yaml_text(p.default_text);
    if (!p.unit.empty()) out_ << ' ' << p.unit;
    out_ << '\n' << indent << name << ": " << yaml_text(p.text()) << '\n';
    first_ = false;
  }

  const ConfigSchema& schema_;
  std::ostream& out_;
  bool first_ = true;
};

}  // namespace

void load_yaml_text(std::string_view text, const std::string& name, const ConfigSchema& schema) {
  SchemaReader reader(schema);
  reader.read(parse_yaml(std::string(text), name, "configuration"));
  reader.apply();
}

void load_yaml_file(const std::filesystem::path& path, const ConfigSchema& schema) {
  load_yaml_text(foreign_content(path, kMaxFileSize), path.string(), schema);
}

EffectiveConfig effective(const ConfigSchema& schema) {
  EffectiveConfig result;
  Fnv1a hash;
  for (const ConfigParameter& p : schema.parameters()) {
    const std::string value = p.text();
    if (!p.fixed) result.values.emplace_back(p.key, value);
    if (!p.in_fingerprint) continue;
    for (const std::string& part : {p.key, value}) {
      hash.add(std::uint64_t{part.size()});
      hash.add(part);
    }
  }
  result.fingerprint = hash.value();
  return result;
}

void write_yaml(const ConfigSchema& schema, std::ostream& out) {
  YamlWriter(schema, out).write_section("", 0);
}

}  // namespace topogeo::support
