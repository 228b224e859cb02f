// Reading and writing of configuration files.
#include "topogeo/support/config_schema.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <ostream>
#include <set>
#include <stdexcept>
#include <system_error>

#include <yaml-cpp/yaml.h>

#include "topogeo/support/hash.hpp"

namespace topogeo::support {
namespace {

constexpr std::size_t kMaxFileSize = 1U << 20U;

/// Fit for a one-line message: short, no control characters.
std::string printable(std::string text) {
  constexpr std::size_t kMaxLength = 60;
  if (text.size() > kMaxLength) text = text.substr(0, kMaxLength) + "...";
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return text;
}

class YamlReader {
 public:
  YamlReader(std::string name, const ConfigSchema& schema)
      : name_(std::move(name)), schema_(schema) {}

  void read(const YAML::Node& root) {
    if (root.IsNull()) return;  // nothing but comments
    if (!root.IsMap()) fail(root, "expected sections of 'key: value' lines");
    read_section(root, "");
  }

  /// Stores all values; called when the whole file is known to be good.
  void apply() const {
    for (const auto& assign : assignments_) assign();
  }

 private:
  [[noreturn]] void fail(const YAML::Node& at, const std::string& what) const {
    const int line = at.Mark().line;
    throw std::runtime_error(name_ + ":" + std::to_string(line + 1) + ": " + what);
  }

  void read_section(const YAML::Node& section, const std::string& path) {
    for (const auto& entry : section) {
      const YAML::Node& key_node = entry.first;
      const YAML::Node& value = entry.second;
      if (!key_node.IsScalar()) fail(key_node, "expected a plain word as key");
      const std::string key = path.empty() ? key_node.Scalar() : path + "." + key_node.Scalar();
      // The schema is finite, so this also ends a YAML alias that contains itself.
      const ConfigParameter* parameter = schema_.find(key);
      const bool is_section = schema_.is_section(key);
      const std::string quoted = "key '" + printable(key) + "'";
      if (parameter == nullptr && !is_section) fail(key_node, quoted + ": " + known_keys(path));
      if (!seen_.insert(key).second) fail(key_node, quoted + ": given twice");
      if (parameter != nullptr) {
        read_value(key_node, value, *parameter);
      } else if (value.IsMap()) {
        read_section(value, key);
      } else if (!value.IsNull()) {  // a section whose keys are all comments is empty, not wrong
        fail(key_node, quoted + ": is a section, expected 'key: value' lines below it");
      }
    }
  }

  void read_value(const YAML::Node& key_node, const YAML::Node& value,
                  const ConfigParameter& parameter) {
    const std::string quoted = "key '" + parameter.key + "'";
    const std::string expected = ": expected " + parameter.expected;
    // A missing value has the position of what follows it.
    if (value.IsNull()) fail(key_node, quoted + " without a value" + expected);
    if (!value.IsScalar()) fail(value, quoted + " with a list or section" + expected);
    // yaml-cpp tags quoted scalars "!": "3" in quotes is a text, not a number.
    const bool is_quoted = value.Tag() == "!";
    auto assign = is_quoted && !parameter.is_text ? std::nullopt : parameter.parse(value.Scalar());
    if (!assign) {
      const std::string shown = printable(value.Scalar());
      fail(value,
           quoted + " = " + (is_quoted ? "\"" + shown + "\"" : "'" + shown + "'") + expected);
    }
    assignments_.push_back(std::move(*assign));
  }

  [[nodiscard]] std::string known_keys(const std::string& path) const {
    const std::string prefix = path.empty() ? "" : path + ".";
    std::vector<std::string> names;
    for (const ConfigParameter& p : schema_.parameters()) {
      if (!p.key.starts_with(prefix)) continue;
      const std::string rest = p.key.substr(prefix.size());
      const std::string child = rest.substr(0, rest.find('.'));
      if (std::ranges::find(names, child) == names.end()) names.push_back(child);
    }
    std::string text = "unknown, expected one of";
    for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? " " : ", ") + names[i];
    return text;
  }

  std::string name_;
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
    } else if (byte < 0x20 || byte == 0x7f) {
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

  /// All keys below `prefix` ("" or "section."); a section comes where its first key was declared.
  void write_section(const std::string& prefix, int depth) {
    std::set<std::string> done;
    for (const ConfigParameter& p : schema_.parameters()) {
      if (!p.key.starts_with(prefix)) continue;
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
  YamlReader reader(name, schema);
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(std::string(text));
    if (documents.size() > 1) {
      throw std::runtime_error(name + ": holds " + std::to_string(documents.size()) +
                               " YAML documents, expected one");
    }
    if (!documents.empty()) reader.read(documents.front());
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(name + ":" + std::to_string(error.mark.line + 1) +
                             ": not valid YAML: " + error.msg);
  }
  reader.apply();
}

void load_yaml_file(const std::filesystem::path& path, const ConfigSchema& schema) {
  const std::string name = path.string();
  if (std::filesystem::is_directory(path)) {
    throw std::runtime_error(name + ": is a directory, expected a YAML file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(name +
                             ": cannot be opened: " + std::generic_category().message(errno));
  }
  std::string text(kMaxFileSize + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw std::runtime_error(name + ": cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMaxFileSize) {
    throw std::runtime_error(name + ": larger than 1 MB, expected a configuration file");
  }
  load_yaml_text(text, name, schema);
}

EffectiveConfig effective(const ConfigSchema& schema) {
  EffectiveConfig result;
  Fnv1a hash;
  for (const ConfigParameter& p : schema.parameters()) {
    result.values.emplace_back(p.key, p.text());
    for (const std::string& part : {p.key, result.values.back().second}) {
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
