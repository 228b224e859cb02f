#include "element_updates.hpp"

#include <set>

#include "topogeo/service/conversions.hpp"

namespace topogeo::map_store {

namespace {

/// Equal but for what changes with every update.
bool same_content(msg::MapElement a, const msg::MapElement& b) {
  a.stamp_ns(b.stamp_ns());
  a.sequence_number(b.sequence_number());
  if (a.kind() != msg::kElementSummary) a.map_version(b.map_version());
  return a == b;
}

}  // namespace

ElementUpdates::Update ElementUpdates::update_to(const topomap::GlobalMap& map,
                                                 std::int64_t stamp_ns) const {
  Update update;
  std::set<Key> present;
  for (msg::MapElement& element : service::to_elements(map, robot_id_, stamp_ns)) {
    present.insert(key_of(element));
    const auto before = sent_.find(key_of(element));
    if (before != sent_.end() && same_content(element, before->second)) continue;
    element.sequence_number(count_ + update.changed.size());
    update.changed.push_back(std::move(element));
  }
  for (const auto& [key, element] : sent_) {
    if (!present.contains(key)) update.gone.push_back(element);
  }
  return update;
}

void ElementUpdates::sent(const msg::MapElement& element) {
  sent_.insert_or_assign(key_of(element), element);
  ++count_;
}

void ElementUpdates::disposed(const msg::MapElement& element) {
  sent_.erase(key_of(element));
}

}  // namespace topogeo::map_store
