#include "map_sender.hpp"

#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::localizer {

namespace {

/// A worker whose reader connects later than this asks again.
constexpr std::chrono::seconds kPatience{5};
/// Largest number of waiting requests.
constexpr std::size_t kMostPending = 256;

}  // namespace

MapSender::MapSender(const messaging::Participant& participant, messaging::EventLoop& loop,
                     const std::string& client_id, FaultHandler on_fault)
    : on_fault_(std::move(on_fault)),
      requests_(participant, {{}, client_id}),
      copies_(participant) {
  loop.on_event([this](const messaging::Event& event) { on_event(event); });
  loop.add<msg::MapRequest>(
      requests_, [this](const msg::MapRequest& request, const messaging::SampleInfo& info) {
        on_request(request, info);
      });
  loop.add(copies_.writer());
}

void MapSender::add(std::shared_ptr<const topomap::LocalMap> map) {
  const std::uint32_t id = map->id;
  maps_[id] = std::move(map);
  hashes_.erase(id);
}

const topomap::LocalMap* MapSender::find(std::uint32_t map_id) const {
  const auto found = maps_.find(map_id);
  return found == maps_.end() ? nullptr : found->second.get();
}

void MapSender::on_request(const msg::MapRequest& request, const messaging::SampleInfo& info) {
  Pending pending{request, service::participant_of(info.writer), Clock::now()};
  if (answer(pending) || pending_.size() >= kMostPending) return;
  pending_.push_back(std::move(pending));
}

bool MapSender::answer(const Pending& pending) {
  const msg::MapRequest& request = pending.request;
  const topomap::LocalMap* map = find(request.map_id());
  if (map != nullptr && !hashes_.contains(map->id)) {
    hashes_[map->id] = topomap::content_hash(*map);
  }
  if (map == nullptr || hashes_.at(map->id) != request.content_hash()) {
    on_fault_("unknown map requested", "worker " + request.worker_id().to_string() + ": map " +
                                           std::to_string(request.map_id()) +
                                           (map == nullptr ? "" : " with other content"));
    return true;
  }
  // A copy to a worker whose reader is not connected yet would be lost.
  if (!copies_.connected(pending.participant)) return false;
  msg::MapCopy copy;
  messaging::set_header(copy, map->robot_id, map->stamp_ns, sequence_);
  messaging::set_worker_id(copy, request.worker_id().c_str());
  copy.local_map(service::to_msg(*map));
  if (!copies_.write(copy, pending.participant)) return false;
  ++sequence_;
  return true;
}

void MapSender::on_event(const messaging::Event& event) {
  if (copies_.follow(event) && event.kind == messaging::EventKind::kMatched) tick();
}

void MapSender::tick() {
  const Clock::time_point oldest = Clock::now() - kPatience;
  std::erase_if(pending_,
                [&](const Pending& pending) { return pending.since < oldest || answer(pending); });
}

}  // namespace topogeo::localizer
