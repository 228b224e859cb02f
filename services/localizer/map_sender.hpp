// Sends local maps to the workers that ask for them, because the map that a task names may reach a
// worker later than the task, or never.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/service/participant_id.hpp"
#include "topogeo/topomap/local_map.hpp"

#include "worker_writer.hpp"

namespace topogeo::localizer {

/// Lives in the thread of its loop.
class MapSender {
 public:
  using FaultHandler = std::function<void(std::string_view reason, std::string_view detail)>;

  /// Answers requests to `client_id`. `loop` must outlive this object and must not run after its
  /// end. Throws like Reader and Writer.
  MapSender(const messaging::Participant& participant, messaging::EventLoop& loop,
            const std::string& client_id, FaultHandler on_fault);

  /// Replaces an earlier map with the same id.
  void add(std::shared_ptr<const topomap::LocalMap> map);
  /// Null when there is no map with that id.
  [[nodiscard]] const topomap::LocalMap* find(std::uint32_t map_id) const;

  /// Call it a few times a second: sends the copies that could not be sent before.
  void tick();

  /// Copies sent so far.
  [[nodiscard]] std::uint64_t sent() const { return sequence_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Pending {
    msg::MapRequest request;
    service::ParticipantId participant{};
    Clock::time_point since;
  };

  void on_request(const msg::MapRequest& request, const messaging::SampleInfo& info);
  void on_event(const messaging::Event& event);
  /// True when the request needs no further work.
  bool answer(const Pending& pending);

  FaultHandler on_fault_;
  messaging::Reader<msg::MapRequest> requests_;
  WorkerWriter<msg::MapCopy> copies_;
  std::map<std::uint32_t, std::shared_ptr<const topomap::LocalMap>> maps_;  // by id
  std::map<std::uint32_t, std::uint64_t> hashes_;                           // of requested maps
  std::list<Pending> pending_;                                              // oldest first
  std::uint64_t sequence_ = 0;
};

}  // namespace topogeo::localizer
