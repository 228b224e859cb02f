// YAML documents, read with the caller's expectations: each access states what it expects, and a
// value that differs is an error "FILE:LINE: KEY: expected ..., got ...".
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::support {

struct YamlEntry;

/// A value of a document, or the place of an absent one. Cheap to copy; keeps the document alive.
/// All errors are std::runtime_error.
class YamlNode {
 public:
  /// The key of the value, or the name of a list item or of the whole document.
  [[nodiscard]] const std::string& name() const;
  /// The same value under another name, for messages.
  [[nodiscard]] YamlNode named(std::string name) const;
  /// Line number from 1; for an absent value, the line of the map that lacks it.
  [[nodiscard]] int line() const;

  [[nodiscard]] bool exists() const;
  /// Absent, or a key without a value.
  [[nodiscard]] bool is_null() const;
  [[nodiscard]] bool is_map() const;
  [[nodiscard]] bool is_list() const;
  [[nodiscard]] bool is_scalar() const;
  /// Whether the value is quoted: "3" in quotes is a text and not a number.
  [[nodiscard]] bool is_quoted() const;

  /// Throws "FILE:LINE: NAME: expected EXPECTED, got GOT"; without `got`, the value.
  [[noreturn]] void fail(const std::string& expected) const;
  [[noreturn]] void fail(const std::string& expected, const std::string& got) const;
  /// Throws "FILE:LINE: MESSAGE".
  [[noreturn]] void fail_with(const std::string& message) const;

  /// Fails unless the value is a map with none but these keys, each once.
  void allow_keys(std::initializer_list<std::string_view> keys) const;
  /// The value of a key; absent if the key is. Fails unless this is a map.
  [[nodiscard]] YamlNode at(const std::string& key) const;
  /// The value of a key that must be there.
  [[nodiscard]] YamlNode required(const std::string& key) const;
  /// Keys and values of a map in the order of the file, including repeated keys. Fails for other
  /// values.
  [[nodiscard]] std::vector<YamlEntry> entries() const;

  /// The items of a list, each named `item_name` or like the list; empty for an absent list. Fails
  /// for other values.
  [[nodiscard]] std::vector<YamlNode> items(const std::string& item_name = {}) const;
  /// The items of a list that must have `size` of them, named like the list.
  [[nodiscard]] std::vector<YamlNode> tuple(std::size_t size, const std::string& expected) const;

  /// A scalar as written, without quotes; fails for lists, maps and absent values.
  [[nodiscard]] std::string text() const;
  /// Like text(), but empty for lists, maps and absent values.
  [[nodiscard]] std::optional<std::string> scalar() const;
  /// A number in [low, high]; `unit` (may be empty) is for the message.
  [[nodiscard]] double number(double low, double high, std::string_view unit) const;
  [[nodiscard]] bool boolean() const;

 private:
  struct Content;
  explicit YamlNode(std::shared_ptr<const Content> content) : content_(std::move(content)) {}
  [[nodiscard]] YamlNode child(Content content) const;

  friend YamlNode parse_yaml(const std::string& text, const std::string& source,
                             std::string root_name);

  std::shared_ptr<const Content> content_;
};

struct YamlEntry {
  YamlNode key;  ///< named like the map
  YamlNode value;
};

/// The only document of a text; `source` replaces the file in messages, `root_name` is the name of
/// the document. An empty text is a document without a value. Fails with "FILE:LINE: not valid
/// YAML: ...", for more than one document, and beyond the limits of foreign_file.hpp: bytes,
/// levels, and values, where an alias counts with all its content.
[[nodiscard]] YamlNode parse_yaml(const std::string& text, const std::string& source,
                                  std::string root_name);

/// A text as a scalar of a YAML file, in quotes if it would otherwise read as another type.
[[nodiscard]] std::string yaml_scalar(const std::string& text);

}  // namespace topogeo::support
