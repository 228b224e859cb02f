#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <vector>

#include <pugixml.hpp>

#include "topogeo/exchange/graphml.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "graph_checks.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

/// The digits of a number in XML, which may have blanks around it and a plus.
std::string_view numeral(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  text = text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
  if (text.size() > 1 && text.starts_with('+') && text[1] != '-') text.remove_prefix(1);
  return text;
}

// A larger number is damaged, as in drawings.
constexpr double kMostCoordinate = 1e6;

class GraphmlReader {
 public:
  explicit GraphmlReader(const std::string& name) : name_(name) {}

  MapGraph read(std::string_view text) {
    if (text.size() > support::kMostXmlBytes) {
      fail(fmt::format("is {} bytes, expected at most {}", text.size(), support::kMostXmlBytes));
    }
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
    if (!result) {
      fail(fmt::format("expected XML, invalid at byte {} ({})", result.offset,
                       result.description()));
    }
    const pugi::xml_node top = document.child("graphml");
    if (!top) fail("expected an element graphml at the top");
    for (const pugi::xml_node key : top.children("key")) {
      if (key_names_.size() == support::kMostKeys) {
        fail(fmt::format("more than {} keys", support::kMostKeys));
      }
      const std::string meaning = key.attribute("attr.name").value();
      key_names_[key.attribute("id").value()] = meaning;
      // A default applies to elements without a datum.
      if (key.child("default")) {
        defaults_[key.attribute("for").value()][meaning] = key.child("default").text().get();
      }
    }
    const pugi::xml_node graph = top.child("graph");
    if (!graph) fail("expected an element graph");
    if (graph.next_sibling("graph")) graph_.notes.push_back("only the first graph is read");
    graph_.map.version = whole(data_of(graph, "graph"), "map_version", 0);
    for (const pugi::xml_node node : graph.children("node")) add_node(node);
    number_nodes();
    for (const pugi::xml_node edge : graph.children("edge")) add_edge(edge);
    settle(graph_, name_);
    return std::move(graph_);
  }

 private:
  using Data = std::map<std::string, std::string>;

  struct FileNode {
    std::string id;
    topomap::MapNode node;
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(name_ + ": " + what);
  }
  [[nodiscard]] std::string here() const { return element_; }

  Data data_of(const pugi::xml_node& element, const char* kind) {
    if (++elements_ > support::kMostXmlElements) {
      fail(fmt::format("more than {} nodes and edges", support::kMostXmlElements));
    }
    element_ = fmt::format("{} '{}'", kind, element.attribute("id").value());
    Data data = defaults_[kind];
    data.merge(Data(defaults_["all"]));
    for (const pugi::xml_node datum : element.children("data")) {
      const std::string key = datum.attribute("key").value();
      const auto name = key_names_.find(key);
      if (name == key_names_.end()) {
        fail(fmt::format("{}: data of key '{}', expected a key that is declared", here(), key));
      }
      data[name->second] = datum.text().get();
    }
    return data;
  }

  double number(const Data& data, const std::string& key, std::optional<double> otherwise) const {
    const auto found = data.find(key);
    if (found == data.end()) {
      if (otherwise) return *otherwise;
      fail(fmt::format("{}: expected a number '{}', got nothing", here(), key));
    }
    return checked(found->second, key);
  }
  double checked(std::string_view text, const std::string& key) const {
    const std::optional<double> value = number_of(numeral(text));
    if (!value || std::fabs(*value) > kMostCoordinate) {
      fail(fmt::format("{}: {}: expected a number from -1e6 to 1e6, got '{}'", here(), key, text));
    }
    return *value;
  }
  std::uint64_t whole(const Data& data, const std::string& key, std::uint64_t otherwise) const {
    const auto found = data.find(key);
    if (found == data.end()) return otherwise;
    const std::optional<std::uint64_t> value = whole_number_of(numeral(found->second));
    if (!value) {
      fail(fmt::format("{}: {}: expected a whole number of 0 or more, got '{}'", here(), key,
                       found->second));
    }
    return *value;
  }
  std::int64_t last_seen(const Data& data) const {
    const auto found = data.find("last_seen");
    if (found == data.end()) return 0;
    const std::optional<std::int64_t> stamp_ns = stamp_of(found->second);
    if (!stamp_ns) {
      fail(fmt::format("{}: last_seen: expected seconds with nine digits, got '{}'", here(),
                       found->second));
    }
    return *stamp_ns;
  }
  std::uint32_t count(const Data& data) const {
    const std::uint64_t value = whole(data, "observations", 1);
    if (value > std::numeric_limits<std::uint32_t>::max()) {
      fail(fmt::format("{}: observations: expected at most 4294967295, got {}", here(), value));
    }
    return static_cast<std::uint32_t>(value);
  }

  void add_node(const pugi::xml_node& element) {
    const Data data = data_of(element, "node");
    const std::string id = element.attribute("id").value();
    if (id.empty() || !ids_.insert(id).second) {
      fail(fmt::format("{}: expected an id that no other node has", here()));
    }
    const double x_m = number(data, "x", std::nullopt);
    const double y_m = number(data, "y", std::nullopt);
    const Eigen::Vector2d position_m(x_m, y_m);
    const auto kind = data.find("kind");
    if (kind != data.end() && kind->second == "place") {
      const auto name = data.find("name");
      if (name == data.end()) fail(here() + ": expected a 'name' of the place, got nothing");
      planning::Place& place = graph_.drawing.places.emplace_back();
      place.name = name->second;
      place.position_m = position_m;
      if (data.contains("station_heading")) {
        place.station_heading_rad = number(data, "station_heading", std::nullopt);
      }
      return;
    }
    FileNode node{id, {}};
    node.node.position_m = position_m;
    node.node.clearance_m = number(data, "clearance", 0.0);
    node.node.observations = count(data);
    node.node.last_seen_ns = last_seen(data);
    if (kind != data.end())
      node.node.kind = topomap::node_kind_of(kind->second).value_or(node.node.kind);
    nodes_.push_back(std::move(node));
  }

  /// Our nodes are called n and their id; foreign ones are numbered.
  static std::optional<std::uint32_t> own_id(std::string_view id, char letter) {
    if (id.size() < 2 || id.front() != letter) return std::nullopt;
    const auto number = whole_number_of(id.substr(1));
    if (!number || *number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
    return static_cast<std::uint32_t>(*number);
  }

  void number_nodes() {
    own_ = std::ranges::all_of(nodes_,
                               [](const FileNode& n) { return own_id(n.id, 'n').has_value(); });
    std::uint32_t next = 1;
    for (FileNode& node : nodes_) {
      node.node.id = own_ ? *own_id(node.id, 'n') : next++;
      places_of_.emplace(node.id, graph_.map.nodes.size());
      graph_.map.nodes.push_back(node.node);
    }
  }

  const FileNode& end_of(const pugi::xml_node& element, const char* which) const {
    const std::string id = element.attribute(which).value();
    const auto found = places_of_.find(id);
    if (found == places_of_.end()) {
      fail(fmt::format("{}: {} '{}': expected the id of a node", here(), which, id));
    }
    return nodes_[found->second];
  }

  void add_edge(const pugi::xml_node& element) {
    const Data data = data_of(element, "edge");
    const FileNode& a = end_of(element, "source");
    const FileNode& b = end_of(element, "target");
    topomap::MapBranch branch;
    branch.node_a = a.node.id;
    branch.node_b = b.node.id;
    const auto own = own_ ? own_id(element.attribute("id").value(), 'b') : std::nullopt;
    branch.id = own.value_or(static_cast<std::uint32_t>(graph_.map.branches.size() + 1));
    branch.observations = count(data);
    branch.last_seen_ns = last_seen(data);
    const auto is_virtual = data.find("virtual");
    branch.is_virtual =
        is_virtual != data.end() && (is_virtual->second == "true" || is_virtual->second == "1");
    if (const auto points = data.find("points"); points != data.end()) {
      branch.points = points_of(points->second);
    } else {
      // A second edge in the opposite direction is the same branch.
      if (&a == &b || !straight_.insert(std::minmax(a.node.id, b.node.id)).second) return;
      branch.points = {{a.node.position_m, a.node.clearance_m},
                       {b.node.position_m, b.node.clearance_m}};
    }
    graph_.map.branches.push_back(std::move(branch));
  }

  std::vector<topomap::BranchPoint> points_of(std::string_view text) const {
    std::vector<double> values;
    while (!text.empty()) {
      const std::size_t blank = std::min(text.find(' '), text.size());
      if (blank > 0) values.push_back(checked(text.substr(0, blank), "points"));
      text.remove_prefix(std::min(blank + 1, text.size()));
    }
    if (values.size() < 6 || values.size() % 3 != 0) {
      fail(
          fmt::format("{}: points: expected x, y and clearance of two points or more, got {} "
                      "numbers",
                      here(), values.size()));
    }
    std::vector<topomap::BranchPoint> points;
    for (std::size_t i = 0; i < values.size(); i += 3) {
      points.push_back({{values[i], values[i + 1]}, values[i + 2]});
    }
    return points;
  }

  const std::string& name_;
  std::string element_;  // current element, for messages
  std::size_t elements_ = 0;
  std::map<std::string, std::string> key_names_;
  std::map<std::string, Data> defaults_;
  std::set<std::string> ids_;
  std::vector<FileNode> nodes_;
  std::map<std::string, std::size_t> places_of_;  // index in nodes_ by id in the file
  std::set<std::pair<std::uint32_t, std::uint32_t>> straight_;
  bool own_ = false;  // the file has our ids
  MapGraph graph_;
};

}  // namespace

MapGraph parse_graphml(std::string_view text, const std::string& name) {
  return GraphmlReader(name).read(text);
}

}  // namespace topogeo::exchange
