#include "topogeo/support/yaml_reader.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "topogeo/support/printable.hpp"

namespace topogeo::support {
namespace {

/// Enough to find the value in the file; a message stays one line.
constexpr std::size_t kMostShown = 60;

std::string shown(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return "nothing";
  if (node.IsSequence()) return "a list of " + std::to_string(node.size());
  if (node.IsMap()) return "a map";
  std::string text = node.Scalar().substr(0, kMostShown);
  if (text.size() < node.Scalar().size()) text += "...";
  return "'" + printable(text) + "'";
}

std::string joined(std::initializer_list<std::string_view> keys, std::string_view last_link) {
  std::string text;
  std::size_t i = 0;
  for (const std::string_view key : keys) {
    if (i > 0) text += i + 1 == keys.size() ? last_link : ", ";
    text += key;
    ++i;
  }
  return text;
}

// yaml-cpp counts from 0 and gives -1 to what has no place in the file.
int line_of(int mark_line) {
  return std::max(mark_line + 1, 1);
}

}  // namespace

struct YamlNode::Content {
  YAML::Node node;
  std::string name;
  int line = 1;
  std::shared_ptr<const std::string> source{};
};

YamlNode YamlNode::child(Content content) const {
  content.source = content_->source;
  content.line = content.node.IsDefined() ? line_of(content.node.Mark().line) : content_->line;
  return YamlNode(std::make_shared<const Content>(std::move(content)));
}

const std::string& YamlNode::name() const {
  return content_->name;
}

YamlNode YamlNode::named(std::string name) const {
  Content content = *content_;
  content.name = std::move(name);
  return YamlNode(std::make_shared<const Content>(std::move(content)));
}

int YamlNode::line() const {
  return content_->line;
}

bool YamlNode::exists() const {
  return content_->node.IsDefined();
}

bool YamlNode::is_null() const {
  return !exists() || content_->node.IsNull();
}

bool YamlNode::is_map() const {
  return exists() && content_->node.IsMap();
}

bool YamlNode::is_list() const {
  return exists() && content_->node.IsSequence();
}

bool YamlNode::is_scalar() const {
  return exists() && content_->node.IsScalar();
}

bool YamlNode::is_quoted() const {
  return is_scalar() && content_->node.Tag() == "!";  // how yaml-cpp marks quoted scalars
}

void YamlNode::fail(const std::string& expected) const {
  fail(expected, shown(content_->node));
}

void YamlNode::fail(const std::string& expected, const std::string& got) const {
  fail_with(name() + ": expected " + expected + ", got " + got);
}

void YamlNode::fail_with(const std::string& message) const {
  throw std::runtime_error(*content_->source + ":" + std::to_string(line()) + ": " + message);
}

void YamlNode::allow_keys(std::initializer_list<std::string_view> keys) const {
  if (!is_map()) fail("a map with the keys " + joined(keys, " and "));
  std::set<std::string> seen;
  for (const YamlEntry& entry : entries()) {
    const std::string key = entry.key.scalar().value_or("");
    if (!entry.key.is_scalar() || std::ranges::find(keys, key) == keys.end()) {
      entry.key.fail("one of the keys " + joined(keys, ", "));
    }
    if (!seen.insert(key).second) entry.key.fail("each key once");
  }
}

YamlNode YamlNode::at(const std::string& key) const {
  if (!is_map()) fail("a map with the key " + key);
  return child({content_->node[key], key});
}

YamlNode YamlNode::required(const std::string& key) const {
  YamlNode value = at(key);
  if (!value.exists()) value.fail("a value", "nothing: key '" + key + "' is missing");
  return value;
}

std::vector<YamlEntry> YamlNode::entries() const {
  if (!is_map()) fail("a map");
  std::vector<YamlEntry> entries;
  for (const auto& entry : content_->node) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : name();
    entries.push_back({child({entry.first, name()}), child({entry.second, key})});
  }
  return entries;
}

std::vector<YamlNode> YamlNode::items(const std::string& item_name) const {
  std::vector<YamlNode> items;
  if (!exists()) return items;
  if (!is_list()) fail("a list");
  for (const YAML::Node& item : content_->node) {
    items.push_back(child({item, item_name.empty() ? name() : item_name}));
  }
  return items;
}

std::vector<YamlNode> YamlNode::tuple(std::size_t size, const std::string& expected) const {
  if (!is_list() || content_->node.size() != size) fail(expected);
  return items();
}

std::string YamlNode::text() const {
  if (!is_scalar()) fail("a text");
  return content_->node.Scalar();
}

std::optional<std::string> YamlNode::scalar() const {
  if (!is_scalar()) return std::nullopt;
  return content_->node.Scalar();
}

double YamlNode::number(double low, double high, std::string_view unit) const {
  double value = 0.0;
  const bool is_number = is_scalar() && YAML::convert<double>::decode(content_->node, value);
  // Written so that a NaN is refused.
  if (!is_number || !(value >= low && value <= high)) {
    std::ostringstream expected;
    expected << "a number from " << low << " to " << high;
    if (!unit.empty()) expected << ' ' << unit;
    fail(expected.str());
  }
  return value;
}

bool YamlNode::boolean() const {
  bool value = false;
  if (!is_scalar() || !YAML::convert<bool>::decode(content_->node, value)) fail("true or false");
  return value;
}

YamlNode parse_yaml(const std::string& text, const std::string& source, std::string root_name) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw std::runtime_error(source + ":1: holds " + std::to_string(documents.size()) +
                               " YAML documents, expected one");
    }
    const YAML::Node root = documents.empty() ? YAML::Node() : documents.front();
    return YamlNode(std::make_shared<const YamlNode::Content>(
        YamlNode::Content{root, std::move(root_name), line_of(root.Mark().line),
                          std::make_shared<const std::string>(source)}));
  } catch (const YAML::Exception& error) {
    throw std::runtime_error(source + ":" + std::to_string(line_of(error.mark.line)) +
                             ": not valid YAML: " + error.msg);
  }
}

std::string yaml_scalar(const std::string& text) {
  YAML::Emitter emitter;
  emitter << text;
  return emitter.c_str();
}

}  // namespace topogeo::support
