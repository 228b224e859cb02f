// A map store's messages: each element with its number, then the summary of all sent elements.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "topogeo/map_client/map_follower.hpp"

namespace topogeo::map_client {

/// One life of a map store.
class SimulatedStore {
 public:
  explicit SimulatedStore(std::uint64_t map_id = 1) : map_id_(map_id) {}

  /// A new or changed node.
  msg::MapElement node(std::uint32_t id, double x_m) {
    msg::MapElement out = element(msg::kElementNode, id);
    out.node_position().x_m(x_m);
    return sent(out);
  }
  /// A branch between two nodes.
  msg::MapElement branch(std::uint32_t id, std::uint32_t node_a, std::uint32_t node_b) {
    msg::MapElement out = element(msg::kElementBranch, id);
    out.node_a(node_a);
    out.node_b(node_b);
    return sent(out);
  }
  /// Removes the element with this kind and id.
  msg::MapElement dispose(msg::MapElementKind kind, std::uint32_t id) {
    return sent_.extract({kind, id}).mapped();
  }
  msg::MapElement summary(std::uint64_t version) {
    msg::MapElement out = element(msg::kElementSummary, 0);
    out.map_version(version);
    out.map_id(map_id_);
    std::uint32_t nodes = 0;
    std::uint64_t hash = 0;
    for (const auto& [key, sample] : sent_) {
      nodes += key.first == msg::kElementNode ? 1 : 0;
      hash += sample_hash(sample);
    }
    out.nodes(nodes);
    out.branches(static_cast<std::uint32_t>(sent_.size()) - nodes);
    out.samples_hash(hash);
    summary_ = out;
    return out;
  }
  /// The samples for a late reader: the last one of each instance.
  [[nodiscard]] std::vector<msg::MapElement> history() const {
    std::vector<msg::MapElement> out;
    for (const auto& [key, sample] : sent_) out.push_back(sample);
    out.push_back(summary_);
    return out;
  }

 private:
  msg::MapElement element(msg::MapElementKind kind, std::uint32_t id) {
    msg::MapElement out;
    out.schema_version(msg::kSchemaVersion);
    out.robot_id("robot");
    out.sequence_number(count_++);
    out.kind(kind);
    out.id(id);
    return out;
  }
  msg::MapElement sent(const msg::MapElement& element) {
    sent_[{element.kind(), element.id()}] = element;
    return element;
  }

  std::uint64_t map_id_;
  std::uint64_t count_ = 0;
  msg::MapElement summary_;
  std::map<std::pair<msg::MapElementKind, std::uint32_t>, msg::MapElement> sent_;
};

}  // namespace topogeo::map_client
