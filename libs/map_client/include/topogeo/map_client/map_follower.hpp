// The exact current map of one robot, assembled from the samples of its map store on the topic
// `map`.
//
// Contains no transport: the reader of the topic passes samples and disposals, in any order and
// with any gaps. The summary of a map states its samples (samples_hash in idl/map_update.idl), so a
// map is shown only when it is complete. A map store that restarts, there or on another machine,
// sends everything again as another writer. The samples of each writer are kept apart, so remains
// of a previous store never mix in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/msg/map_update.h"

namespace topogeo::map_client {

/// Identifies an instance of the topic, or a writer, as in DDS.
using Handle = std::array<std::uint8_t, 16>;

using Element = std::shared_ptr<const msg::MapElement>;
/// Nodes or branches, by id.
using Elements = std::map<std::uint32_t, Element>;

/// A map in the state of the map store at `version`.
struct Map {
  std::uint64_t map_id = 0;
  std::uint64_t version = 0;  ///< version of the trajectory it is based on
  std::int64_t stamp_ns = 0;  ///< of the last stop in it
  Elements nodes = {};
  Elements branches = {};
};

/// A new element (no `before`), a changed one, or a removed one (no `now`).
struct Change {
  Element before;
  Element now;
};

/// The part of one sample in the hash of samples in a summary.
inline std::uint64_t sample_hash(const msg::MapElement& element) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
  const auto add = [&](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) hash = (hash ^ ((value >> 8 * i) & 0xffU)) * 0x100000001b3ULL;
  };
  add(element.kind(), 4);
  add(element.id(), 4);
  add(element.sequence_number(), 8);
  return hash;
}

/// True if two elements describe the same part of the floor, whenever they were sent.
inline bool same_content(const msg::MapElement& a, const msg::MapElement& b) {
  return a.kind() == b.kind() && a.id() == b.id() && a.observations() == b.observations() &&
         a.last_seen_ns() == b.last_seen_ns() && a.node_kind() == b.node_kind() &&
         a.node_position() == b.node_position() && a.node_a() == b.node_a() &&
         a.node_b() == b.node_b() && a.is_virtual() == b.is_virtual() && a.points() == b.points();
}

/// Not thread-safe.
class MapFollower {
 public:
  explicit MapFollower(std::string robot_id) : robot_id_(std::move(robot_id)) {}

  /// Adds a sample. `instance` and `writer` are those of DDS's SampleInfo (instance_handle,
  /// publication_handle). Samples of other robots are ignored. True if map() has changed.
  bool put(const msg::MapElement& element, const Handle& instance, const Handle& writer);

  /// Handles a disposal, which carries no element. Do not report instances that have only lost
  /// their writer: a map stays when its map store stops.
  bool remove(const Handle& instance, const Handle& writer);

  /// The topic is read again from its beginning. map() stays unchanged until all samples have
  /// arrived.
  void begin_again() { sources_.clear(); }

  /// The newest complete map; null before the first. Valid until the next put() or remove(); its
  /// elements never change and may be kept.
  [[nodiscard]] const Map* map() const { return map_ ? map_.get() : nullptr; }

  /// True if map() includes all samples of the map store. False without a map, or if parts of a
  /// newer one have arrived.
  [[nodiscard]] bool is_current() const;

  /// Changes from the map of the last call, if any, to map(). Changes of the versions in between
  /// are combined.
  std::vector<Change> take_changes();

 private:
  using Key = std::pair<msg::MapElementKind, std::uint32_t>;
  /// Samples of one writer that are not disposed.
  struct Source {
    std::map<Handle, Key> keys;
    Elements nodes;
    Elements branches;
    Element summary;
    std::uint64_t samples_hash = 0;
    std::uint64_t newest = 0;  // sequence number

    void put(const Key& key, Element element);
    void remove(const Key& key);
    [[nodiscard]] bool is_whole() const;
  };

  bool show(const Handle& writer);
  static void add_changes(const Elements& before, const Elements& now, std::vector<Change>& out);

  std::string robot_id_;
  std::map<Handle, Source> sources_;  // by writer
  std::shared_ptr<const Map> map_;
  std::shared_ptr<const Map> taken_;  // map_ at the last take_changes()
  std::uint64_t shown_sample_ = 0;    // number of the summary of map_
  Handle shown_writer_{};
};

inline void MapFollower::Source::put(const Key& key, Element element) {
  newest = element->sequence_number();
  if (key.first == msg::kElementSummary) {
    summary = std::move(element);
    return;
  }
  Element& held = (key.first == msg::kElementNode ? nodes : branches)[key.second];
  if (held) samples_hash -= sample_hash(*held);
  samples_hash += sample_hash(*element);
  held = std::move(element);
}

inline void MapFollower::Source::remove(const Key& key) {
  if (key.first == msg::kElementSummary) {
    summary.reset();
    return;
  }
  Elements& elements = key.first == msg::kElementNode ? nodes : branches;
  const auto held = elements.find(key.second);
  if (held == elements.end()) return;
  samples_hash -= sample_hash(*held->second);
  elements.erase(held);
}

inline bool MapFollower::Source::is_whole() const {
  return summary && summary->nodes() == nodes.size() && summary->branches() == branches.size() &&
         summary->samples_hash() == samples_hash;
}

inline bool MapFollower::put(const msg::MapElement& element, const Handle& instance,
                             const Handle& writer) {
  if (element.schema_version() != msg::kSchemaVersion || element.robot_id() != robot_id_.c_str()) {
    return false;
  }
  const Key key{element.kind(), element.id()};
  Source& source = sources_[writer];
  source.put(key, std::make_shared<const msg::MapElement>(element));
  source.keys[instance] = key;
  return show(writer);
}

inline bool MapFollower::remove(const Handle& instance, const Handle& writer) {
  const auto source = sources_.find(writer);
  if (source == sources_.end()) return false;
  const auto key = source->second.keys.find(instance);
  if (key == source->second.keys.end()) return false;  // gone before its sample was read
  source->second.remove(key->second);
  source->second.keys.erase(key);
  return show(writer);
}

inline bool MapFollower::show(const Handle& writer) {
  const Source& source = sources_.at(writer);
  if (!source.is_whole()) return false;
  // Drops other writers: their samples are older and can no longer become a map.
  std::erase_if(sources_, [&](const auto& other) { return other.first != writer; });
  const msg::MapElement& summary = *source.summary;
  if (map_ && shown_writer_ == writer && shown_sample_ == summary.sequence_number()) return false;
  shown_writer_ = writer;
  shown_sample_ = summary.sequence_number();
  map_ = std::make_shared<const Map>(Map{summary.map_id(), summary.map_version(),
                                         summary.stamp_ns(), source.nodes, source.branches});
  return true;
}

inline bool MapFollower::is_current() const {
  if (!map_ || sources_.empty()) return false;
  for (const auto& [writer, source] : sources_) {
    if (!source.is_whole()) return false;
  }
  return true;
}

inline std::vector<Change> MapFollower::take_changes() {
  static const Map kNone;
  std::vector<Change> changes;
  if (map_ && map_ != taken_) {
    const Map& before = taken_ ? *taken_ : kNone;
    add_changes(before.nodes, map_->nodes, changes);
    add_changes(before.branches, map_->branches, changes);
    taken_ = map_;
  }
  return changes;
}

inline void MapFollower::add_changes(const Elements& before, const Elements& now,
                                     std::vector<Change>& out) {
  auto old = before.begin();
  for (const auto& [id, element] : now) {
    for (; old != before.end() && old->first < id; ++old) out.push_back({old->second, nullptr});
    if (old == before.end() || old->first != id) {
      out.push_back({nullptr, element});
      continue;
    }
    if (old->second != element && !same_content(*old->second, *element)) {
      out.push_back({old->second, element});
    }
    ++old;
  }
  for (; old != before.end(); ++old) out.push_back({old->second, nullptr});
}

}  // namespace topogeo::map_client
