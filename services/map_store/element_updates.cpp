#include "element_updates.hpp"

#include <bit>
#include <set>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::map_store {

namespace {

/// Hash of an element's content, independent of when it is sent; for a summary, hash of its counts.
std::uint64_t content_of(const msg::MapElement& element) {
  support::Fnv1a hash;
  const auto add = [&](const msg::BranchPoint& point) {
    for (const double value : {point.x_m(), point.y_m(), point.clearance_m()}) {
      hash.add(std::bit_cast<std::uint64_t>(value));
    }
  };
  if (element.kind() == msg::kElementSummary) {
    for (const std::uint64_t value :
         {element.map_version(), element.map_id(), std::uint64_t{element.nodes()},
          std::uint64_t{element.branches()}}) {
      hash.add(value);
    }
    return hash.value();
  }
  hash.add(std::uint64_t{element.observations()});
  hash.add(static_cast<std::uint64_t>(element.last_seen_ns()));
  hash.add(std::uint64_t{element.node_kind()});
  add(element.node_position());
  hash.add(std::uint64_t{element.node_a()} << 32U | element.node_b());
  hash.add(std::uint64_t{element.is_virtual()});
  for (const msg::BranchPoint& point : element.points()) add(point);
  return hash.value();
}

}  // namespace

ElementUpdates::Update ElementUpdates::update_to(const topomap::GlobalMap& map,
                                                 std::uint64_t map_id,
                                                 std::int64_t stamp_ns) const {
  Update update;
  std::set<Key> present;
  bool same_summary = false;
  for (msg::MapElement& element : service::to_elements(map, map_id, robot_id_, stamp_ns)) {
    const Key key = key_of(element);
    present.insert(key);
    const auto before = sent_.find(key);
    const bool same = before != sent_.end() && before->second.content == content_of(element);
    if (key.first == msg::kElementSummary) {
      same_summary = same;
    } else if (same) {
      continue;
    }
    update.changed.push_back(std::move(element));
  }
  for (const auto& [key, sent] : sent_) {
    if (present.contains(key)) continue;
    msg::MapElement& gone = update.gone.emplace_back();
    messaging::set_header(gone, robot_id_, stamp_ns, 0);
    gone.kind(key.first);
    gone.id(key.second);
  }
  // Any other change also changes the summary.
  if (same_summary && update.gone.empty() && update.changed.size() == 1) update.changed.clear();
  return update;
}

void ElementUpdates::number(msg::MapElement& element) const {
  element.sequence_number(count_);
  if (element.kind() == msg::kElementSummary) element.samples_hash(samples_hash_);
}

void ElementUpdates::sent(const msg::MapElement& element) {
  forget(key_of(element));  // the previous sample
  const bool counts = element.kind() != msg::kElementSummary;
  const Sent sent{content_of(element), counts ? map_client::sample_hash(element) : 0};
  samples_hash_ += sent.sample;
  sent_.emplace(key_of(element), sent);
  ++count_;
}

void ElementUpdates::disposed(const msg::MapElement& element) {
  forget(key_of(element));
}

void ElementUpdates::forget(const Key& key) {
  const auto sent = sent_.find(key);
  if (sent == sent_.end()) return;
  samples_hash_ -= sent->second.sample;
  sent_.erase(sent);
}

}  // namespace topogeo::map_store
