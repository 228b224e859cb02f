#include "topogeo/support/yaml_reader.hpp"

#include <algorithm>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/printable.hpp"

namespace topogeo::support {
namespace {

/// Enough to find the value in the file, and short enough for one line.
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

// yaml-cpp counts from 0 and gives -1 to values without a place in the file.
int line_of(int mark_line) {
  return std::max(mark_line + 1, 1);
}

[[noreturn]] void fail_at(const std::string& source, int line, const std::string& what) {
  throw std::runtime_error(source + ":" + std::to_string(line) + ": " + what);
}

[[noreturn]] void fail_levels(const std::string& source, int line) {
  fail_at(source, line,
          "more than " + std::to_string(kMostLevels) + " levels of nested lists and maps");
}

[[noreturn]] void fail_values(const std::string& source, int line) {
  fail_at(source, line,
          "more than " + std::to_string(kMostYamlValues) +
              " values, where an alias counts with everything it refers to");
}

/// Builds nothing, and throws if a text has more values or levels than allowed: a node of yaml-cpp
/// takes half a kilobyte.
class YamlLimitCheck final : public YAML::EventHandler {
 public:
  explicit YamlLimitCheck(const std::string& source) : source_(source) {}

  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { count(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { count(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {
    count(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/,
                       YAML::anchor_t /*anchor*/, YAML::EmitterStyle::value /*style*/) override {
    enter(mark);
  }
  void OnSequenceEnd() override { --levels_; }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    enter(mark);
  }
  void OnMapEnd() override { --levels_; }

 private:
  void count(const YAML::Mark& mark) {
    if (++values_ > kMostYamlValues) fail_values(source_, line_of(mark.line));
  }
  void enter(const YAML::Mark& mark) {
    count(mark);
    if (++levels_ > kMostLevels) fail_levels(source_, line_of(mark.line));
  }

  const std::string& source_;
  std::size_t values_ = 0;
  std::size_t levels_ = 0;
};

/// Counts the values below a node, those behind aliases each time, because readers visit all of
/// them. An alias within its own content would have endless levels.
void count_values(const YAML::Node& node, const std::string& source, std::size_t levels,
                  std::size_t& values) {
  if (++values > kMostYamlValues) fail_values(source, line_of(node.Mark().line));
  if (!node.IsMap() && !node.IsSequence()) return;
  if (levels == kMostLevels) fail_levels(source, line_of(node.Mark().line));
  for (const auto& entry : node) {
    if (node.IsMap()) {
      count_values(entry.first, source, levels + 1, values);
      count_values(entry.second, source, levels + 1, values);
    } else {
      count_values(entry, source, levels + 1, values);
    }
  }
}

/// Throws if a text exceeds the limits of foreign files.
void check_extent(const std::string& text, const std::string& source) {
  if (text.size() > kMostYamlBytes) {
    fail_at(source, 1,
            "is " + std::to_string(text.size()) + " bytes, expected at most " +
                std::to_string(kMostYamlBytes));
  }
  std::istringstream in(text);
  YAML::Parser parser(in);
  YamlLimitCheck check(source);
  while (parser.HandleNextDocument(check)) {
  }
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
  return is_scalar() && content_->node.Tag() == "!";  // the tag of quoted scalars in yaml-cpp
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
    check_extent(text, source);
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) {
      throw std::runtime_error(source + ":1: holds " + std::to_string(documents.size()) +
                               " YAML documents, expected one");
    }
    const YAML::Node root = documents.empty() ? YAML::Node() : documents.front();
    // Without an alias the text itself contains all values, which are counted already.
    std::size_t values = 0;
    if (text.find('*') != std::string::npos) count_values(root, source, 0, values);
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
