#include "hybrid_updates.hpp"

#include <string_view>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/hybrid_map_messages.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::map_store {

namespace {

/// Equal except for the fields that change with every update.
bool same_tile(msg::HybridMap a, const msg::HybridMap& b) {
  a.stamp_ns(b.stamp_ns());
  a.sequence_number(b.sequence_number());
  a.version(b.version());
  return a == b;
}

std::uint64_t content_of_cells(const msg::GridTile& tile) {
  support::Fnv1a hash;
  const auto bytes = [](const auto& cells) {
    return std::string_view(reinterpret_cast<const char*>(cells.data()),
                            cells.size() * sizeof(cells.front()));
  };
  hash.add(bytes(tile.states()));
  hash.add(bytes(tile.zones()));
  return hash.value();
}

}  // namespace

HybridUpdates::Update HybridUpdates::update_to(const planning::HybridMap& map,
                                               std::int64_t stamp_ns) {
  service::HybridMapMessages messages =
      service::to_messages(map, robot_id_, stamp_ns, version_ + 1);
  Update update;
  for (msg::GridTile& tile : messages.tiles) {
    const auto before = sent_.find(tile.tile());
    if (before != sent_.end() && before->second.content == content_of_cells(tile)) {
      messages.summary.tile_versions()[tile.tile()] = before->second.version;
      continue;
    }
    tile.sequence_number(count_ + update.changed.size());
    update.changed.push_back(std::move(tile));
  }
  for (const auto& [number, tile] : sent_) {
    if (number < messages.tiles.size()) continue;
    msg::GridTile& gone = update.gone.emplace_back();
    messaging::set_header(gone, robot_id_, stamp_ns, 0);
    gone.tile(number);
  }
  messages.summary.sequence_number(summaries_);
  if (!sent_summary_ || !update.changed.empty() || !same_tile(messages.summary, *sent_summary_)) {
    ++version_;
    update.summary = std::move(messages.summary);
  }
  return update;
}

void HybridUpdates::sent(const msg::GridTile& tile) {
  sent_.insert_or_assign(tile.tile(), SentTile{tile.version(), content_of_cells(tile)});
  ++count_;
}

void HybridUpdates::sent(const msg::HybridMap& summary) {
  sent_summary_ = summary;
  ++summaries_;
}

}  // namespace topogeo::map_store
