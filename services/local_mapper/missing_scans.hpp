// Requests the scans that a log's gateway sent while this service was not running.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/stream.h"
#include "topogeo/service/service.hpp"

namespace topogeo::local_mapper {

/// Must be used in the loop of its service only.
class MissingScans {
 public:
  explicit MissingScans(service::Service& service);
  ~MissingScans();
  MissingScans(const MissingScans&) = delete;
  MissingScans& operator=(const MissingScans&) = delete;

  /// Requests the scans from number `first` on, of the log with that odometry epoch, and repeats
  /// the request until found(). Returns false when no gateway takes such requests, or none answers
  /// in time.
  bool want(std::uint64_t odometry_epoch, std::uint64_t first);
  /// Ends the requests, because the scans arrive or are not needed any more.
  void found();

 private:
  using Clock = std::chrono::steady_clock;

  void ask();
  void tick();

  service::Service& service_;
  messaging::Writer<msg::ScanRequest> requests_;
  std::optional<msg::ScanRequest> wanted_;
  std::uint64_t sent_ = 0;
  bool heard_by_nobody_ = false;  // no gateway was matched when the request was sent
  Clock::time_point asked_;
  Clock::time_point since_;    // time of the first request for these scans
  Clock::time_point matched_;  // when requests last had a reader
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::local_mapper
