#include "topogeo/service/map_mirror.hpp"

#include "topogeo/service/conversions.hpp"

namespace topogeo::service {

void MapMirror::put(const msg::MapElement& element, const messaging::Handle& instance) {
  switch (element.kind()) {
    case msg::kElementNode:
      nodes_[element.id()] = node_from_msg(element);
      break;
    case msg::kElementBranch:
      branches_[element.id()] = branch_from_msg(element);
      break;
    case msg::kElementSummary:
      summary_ = Summary{element.map_version(), element.nodes(), element.branches()};
      break;
  }
  keys_[instance] = {element.kind(), element.id()};
}

void MapMirror::remove(const messaging::Handle& instance) {
  const auto found = keys_.find(instance);
  if (found == keys_.end()) return;
  const auto [kind, id] = found->second;
  keys_.erase(found);
  switch (kind) {
    case msg::kElementNode:
      nodes_.erase(id);
      break;
    case msg::kElementBranch:
      branches_.erase(id);
      break;
    case msg::kElementSummary:
      summary_.reset();
      break;
  }
}

std::optional<topomap::GlobalMap> MapMirror::map() const {
  if (!summary_ || summary_->nodes != nodes_.size() || summary_->branches != branches_.size()) {
    return std::nullopt;
  }
  topomap::GlobalMap map;
  map.version = summary_->version;
  for (const auto& [id, node] : nodes_) map.nodes.push_back(node);
  for (const auto& [id, branch] : branches_) {
    if (!nodes_.contains(branch.node_a) || !nodes_.contains(branch.node_b)) return std::nullopt;
    map.branches.push_back(branch);
  }
  return map;
}

}  // namespace topogeo::service
