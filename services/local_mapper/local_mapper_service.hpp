// Connects pipeline::LocalMapper to topics: scans in, local maps out.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/store_client.hpp"

#include "missing_scans.hpp"
#include "sent_maps.hpp"

namespace topogeo::local_mapper {

/// Lives in the loop of its service.
class LocalMapperService {
 public:
  /// `replay`: the scans come from a log and none may be lost. `standalone`: there is no map store,
  /// hence no session to continue.
  LocalMapperService(service::Service& service, bool replay, bool standalone);

 private:
  /// The beam geometry common to all scans of a source.
  struct Geometry {
    double angle_min_rad = 0.0;
    double angle_step_rad = 0.0;
    std::size_t beams = 0;
    friend bool operator==(const Geometry&, const Geometry&) = default;
  };

  void on_stored(const msg::StoredMap& stored);
  /// Disposes local maps that late readers can get elsewhere.
  void release();
  void on_last_stop(const service::StoreClient::Answer& answer);
  /// Starts reading, once the session to continue is known.
  void begin();
  void on_scan(const msg::Scan& message);
  /// Returns the scan if it continues those before. Otherwise reports a fault, or requests the
  /// missing scans of the log once more.
  std::optional<scan::Scan> accept(const msg::Scan& message);
  void on_stream_end(const msg::StreamEnd& message);
  /// Called after the end of a log. If scans are missing and none arrive any more, they were sent
  /// while this service was away. `next_before`: next_sequence_ at the last check.
  void look_for_rest(std::uint64_t next_before);
  /// False when the missing scans will not arrive: the log has then ended without them.
  bool want_rest();
  void publish(const topomap::LocalMap& map);
  /// Publishes the pose of the last scan relative to the last stop.
  void publish_tracked();
  void finish_if_complete();

  service::Service& service_;
  pipeline::LocalMapper mapper_;
  messaging::Writer<msg::LocalMap> local_maps_;
  messaging::Writer<msg::TrackedPose> tracked_poses_;
  messaging::Writer<msg::StreamEnd> ends_out_;

  bool replay_;
  bool begun_ = false;
  std::optional<msg::StoredMap> stored_;
  std::optional<service::StoreClient> store_;
  std::optional<std::uint64_t> odometry_epoch_;  // of the last scan
  /// Epoch and scan of the stop after which the session continues.
  std::optional<std::pair<std::uint64_t, std::uint64_t>> resumed_;
  std::uint64_t next_sequence_ = 0;  // of the scan that is expected
  std::uint64_t scans_used_ = 0;
  std::int64_t last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  std::optional<Geometry> geometry_;
  std::uint64_t maps_ = 0;
  SentMaps sent_;
  std::uint64_t tracked_ = 0;
  std::uint64_t matched_ = 0;
  std::optional<std::uint64_t> scans_in_stream_;
  std::optional<MissingScans> missing_;  // of a log
  std::uint64_t rest_timer_ = 0;
  bool finished_ = false;
};

}  // namespace topogeo::local_mapper
