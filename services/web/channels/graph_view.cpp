#include "channels/graph_view.hpp"

#include <memory>
#include <utility>
#include <vector>

#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"

#include "channels/protocol_names.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

using messaging::SampleInfo;

std::string robot_of_map(const service::Service& service) {
  const std::string& other = service.setup().options.map_robot;
  return other.empty() ? service.robot_id() : other;
}

std::string key_of(const msg::MapElement& element) {
  return (element.kind() == msg::kElementNode ? "n" : "b") + std::to_string(element.id());
}

std::string node_json(const msg::MapElement& node) {
  return text_of(Json{{"kind", name_of(node.node_kind())},
                      {"x_m", rounded(node.node_position().x_m())},
                      {"y_m", rounded(node.node_position().y_m())},
                      {"clearance_m", rounded(node.node_position().clearance_m())},
                      {"seen", node.observations()}});
}

std::string branch_json(const msg::MapElement& branch) {
  Json points = Json::array();
  for (const msg::BranchPoint& point : branch.points()) {
    points.push_back(rounded(point.x_m()));
    points.push_back(rounded(point.y_m()));
  }
  return text_of(Json{{"a", branch.node_a()},
                      {"b", branch.node_b()},
                      {"virtual", branch.is_virtual()},
                      {"seen", branch.observations()},
                      {"points_m", std::move(points)}});
}

}  // namespace

GraphView::GraphView(service::Service& service, ChannelHub& hub)
    : hub_(hub), follower_(robot_of_map(service)) {
  service.subscribe<msg::MapElement>(
      [this](const msg::MapElement& element, const SampleInfo& info) {
        if (follower_.put(element, info.instance.bytes, info.writer.bytes)) show();
      },
      {.of_map = true},
      [this](const SampleInfo& info) {
        if (info.state != messaging::InstanceState::kDisposed) return;
        if (follower_.remove(info.instance.bytes, info.writer.bytes)) show();
      });
}

void GraphView::show() {
  changed_ = true;
  std::vector<Edit> edits;
  for (const map_client::Change& change : follower_.take_changes()) {
    const msg::MapElement& element = change.now ? *change.now : *change.before;
    std::string json;
    if (change.now) {
      json = element.kind() == msg::kElementNode ? node_json(element) : branch_json(element);
    }
    edits.push_back({key_of(element), std::move(json)});
  }
  const map_client::Map& map = *follower_.map();
  edits.push_back({"map", text_of(Json{{"map_id", fmt::format("{:016x}", map.map_id)},
                                       {"version", std::to_string(map.version)},
                                       {"nodes", map.nodes.size()},
                                       {"branches", map.branches.size()}})});
  hub_.edit(Channel::kGraph, std::move(edits));
}

std::shared_ptr<const topomap::GlobalMap> GraphView::map() {
  if (std::exchange(changed_, false)) {
    map_ = std::make_shared<const topomap::GlobalMap>(service::from_elements(*follower_.map()));
  }
  return map_;
}

}  // namespace topogeo::web
