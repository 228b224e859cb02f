#include "element_updates.hpp"

#include <set>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::map_store {

namespace {

bool same_summary(const msg::MapElement& a, const msg::MapElement& b) {
  return a.map_version() == b.map_version() && a.map_id() == b.map_id() && a.nodes() == b.nodes() &&
         a.branches() == b.branches();
}

}  // namespace

ElementUpdates::Update ElementUpdates::update_to(const topomap::GlobalMap& map,
                                                 std::uint64_t map_id,
                                                 std::int64_t stamp_ns) const {
  Update update;
  std::set<Key> present;
  for (msg::MapElement& element : service::to_elements(map, map_id, robot_id_, stamp_ns)) {
    const Key key = key_of(element);
    present.insert(key);
    const auto before = sent_.find(key);
    if (key.first != msg::kElementSummary && before != sent_.end() &&
        map_client::same_content(element, before->second)) {
      continue;
    }
    update.changed.push_back(std::move(element));
  }
  for (const auto& [key, element] : sent_) {
    if (!present.contains(key)) update.gone.push_back(element);
  }
  const auto summary = sent_.find({msg::kElementSummary, 0});
  if (summary != sent_.end() && update.gone.empty() && update.changed.size() == 1 &&
      same_summary(summary->second, update.changed.front())) {
    update.changed.clear();
  }
  return update;
}

void ElementUpdates::number(msg::MapElement& element) const {
  element.sequence_number(count_);
  if (element.kind() == msg::kElementSummary) element.samples_hash(samples_hash_);
}

void ElementUpdates::sent(const msg::MapElement& element) {
  if (element.kind() != msg::kElementSummary) {
    disposed(element);  // the sample before
    samples_hash_ += map_client::sample_hash(element);
  }
  sent_.insert_or_assign(key_of(element), element);
  ++count_;
}

void ElementUpdates::disposed(const msg::MapElement& element) {
  const auto before = sent_.find(key_of(element));
  if (before == sent_.end()) return;
  samples_hash_ -= map_client::sample_hash(before->second);
  sent_.erase(before);
}

}  // namespace topogeo::map_store
