// A drive through a world for tests of the map store: plays local mapper and localizer.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/store.h"
#include "topogeo/msg/stream.h"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/world/world.hpp"

#include "program.hpp"

namespace topogeo::test {

class StoredDrive {
 public:
  StoredDrive(const std::string& domain, const std::string& partition, const std::string& name)
      : participant_([&] {
          messaging::ParticipantOptions options;
          options.domain = static_cast<std::uint32_t>(std::stoul(domain));
          options.partition = partition;
          options.name = "drive";
          return options;
        }()) {
    pipeline::MappingRun run({}, "robot");
    const world::World world =
        world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/" + name + ".world.yaml");
    for (const scan::Scan& scan : simulation::simulate_log(world, {}).scans) run.add(scan);
    map_ = run.finish();
    loop_.add<msg::StoredMap>(stored_reader_, [this](const msg::StoredMap& stored, const auto&) {
      stored_ = stored;
      most_stored_ = std::max(most_stored_, stored.session_stops());
    });
    loop_.add<msg::SnapshotPiece>(pieces_reader_,
                                  [this](const msg::SnapshotPiece& piece, const auto&) {
                                    if (piece.request_id() == requests_) pieces_.push_back(piece);
                                  });
  }

  /// Sends the stops up to a number, and a trajectory of them with that number as version. Each
  /// stop is turned by `bend_rad` against the one before, like after a loop closure.
  void send(std::size_t stops, double bend_rad = 0.0) {
    for (; sent_ < stops; ++sent_) {
      EXPECT_TRUE(maps_.write(service::to_msg(as_sent(sent_))));
    }
    topomap::Trajectory part = map_.trajectory;
    part.stops.resize(stops);
    part.version = stops == map_.local_maps.size() ? map_.trajectory.version : stops;
    bend(part, bend_rad);
    for (const auto& segment : service::to_segments(part, "robot", 0)) {
      EXPECT_TRUE(segments_.write(segment));
    }
  }
  /// Sends all edges, once.
  void send_edges() {
    if (std::exchange(edges_sent_, true)) return;
    for (std::uint32_t i = 0; i < service::edge_segment_count(map_.edges.size()); ++i) {
      EXPECT_TRUE(
          edges_.write(service::to_segment(map_.edges, i, map_.trajectory.version, "robot", 0, i)));
    }
  }
  void finish() {
    send(map_.local_maps.size());
    const std::uint64_t version = map_.trajectory.version;
    EXPECT_TRUE(closures_.write(service::to_msg(map_.loop_closures, version, "robot", 0, 0)));
    send_edges();
    msg::StreamEnd end;
    messaging::set_header(end, "robot", map_.local_maps.back().stamp_ns, 0);
    end.stage(msg::kStageLocalizer);
    end.count(map_.trajectory.stops.size());
    end.version(version);
    EXPECT_TRUE(ends_.write(end));
  }

  bool wait_until(const std::string& what, const std::function<bool()>& done) {
    return wait_in_loop(loop_, what, done);
  }
  void run_for(std::chrono::milliseconds duration) { static_cast<void>(loop_.run_for(duration)); }
  bool wait_for_stored(std::size_t stops) {
    return wait_until("stored stops",
                      [&] { return stored_.session_stops() >= stops && stored_.stops() >= stops; });
  }

  /// The bytes of an answer; fails without one.
  std::string ask(msg::SnapshotKind kind, std::uint64_t session = 0, std::uint32_t first = 0) {
    pieces_.clear();
    msg::SnapshotRequest request;
    messaging::set_header(request, "robot", 0, requests_);
    request.request_id(++requests_);
    messaging::set_client_id(request, kClient);
    request.kind(kind);
    request.session(session);
    request.first(first);
    EXPECT_TRUE(wait_until("the map store", [&] { return requests_writer_.matched() > 0; }));
    EXPECT_TRUE(requests_writer_.write(request));
    EXPECT_TRUE(wait_until("all pieces of the answer", [&] {
      return !pieces_.empty() && pieces_.size() >= pieces_[0].pieces();
    })) << pieces_.size();
    std::string bytes;
    for (const msg::SnapshotPiece& piece : pieces_) {
      bytes.append(piece.bytes().begin(), piece.bytes().end());
    }
    return bytes;
  }

  [[nodiscard]] topomap::LocalMap as_sent(std::size_t number) const {
    return map_.local_maps[number];  // one session: numbered in the order of sending
  }
  [[nodiscard]] const storage::MapDocument& map() const { return map_; }
  [[nodiscard]] std::uint32_t stops() const {
    return static_cast<std::uint32_t>(map_.local_maps.size());
  }
  [[nodiscard]] const msg::StoredMap& stored() const { return stored_; }
  [[nodiscard]] std::uint32_t most_stored() const { return most_stored_; }

 private:
  static constexpr const char* kClient = "drive";

  static void bend(topomap::Trajectory& trajectory, double bend_rad) {
    if (bend_rad == 0.0) return;
    const std::vector<topomap::StopPose> stops = trajectory.stops;
    for (std::size_t i = 1; i < stops.size(); ++i) {
      const geometry::Pose2 step =
          geometry::between(stops[i - 1].T_map_robot, stops[i].T_map_robot);
      trajectory.stops[i].T_map_robot =
          trajectory.stops[i - 1].T_map_robot * geometry::Pose2{0.0, 0.0, bend_rad} * step;
    }
  }

  storage::MapDocument map_;
  messaging::Participant participant_;
  messaging::EventLoop loop_;
  messaging::Writer<msg::LocalMap> maps_{participant_};
  messaging::Writer<msg::TrajectorySegment> segments_{participant_};
  messaging::Writer<msg::LoopClosures> closures_{participant_};
  messaging::Writer<msg::MapEdges> edges_{participant_};
  messaging::Writer<msg::StreamEnd> ends_{participant_};
  messaging::Writer<msg::SnapshotRequest> requests_writer_{participant_};
  messaging::Reader<msg::StoredMap> stored_reader_{participant_};
  messaging::Reader<msg::SnapshotPiece> pieces_reader_{participant_, {.addressee = kClient}};
  std::vector<msg::SnapshotPiece> pieces_;
  std::uint64_t requests_ = 0;
  msg::StoredMap stored_;
  std::uint32_t most_stored_ = 0;
  std::size_t sent_ = 0;
  bool edges_sent_ = false;
};

}  // namespace topogeo::test
