// Asks the gateway of a log for the scans that it sent while this service was away.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/stream.h"
#include "topogeo/service/service.hpp"

namespace topogeo::local_mapper {

/// Lives in the loop of its service.
class MissingScans {
 public:
  explicit MissingScans(service::Service& service);
  ~MissingScans();
  MissingScans(const MissingScans&) = delete;
  MissingScans& operator=(const MissingScans&) = delete;

  /// Wants the scans of the log of that odometry epoch from number `first` on; asks again and again
  /// until found(). False when that is in vain: nobody takes such requests, or nobody answers.
  bool want(std::uint64_t odometry_epoch, std::uint64_t first);
  /// They come, or are wanted no more.
  void found();

 private:
  using Clock = std::chrono::steady_clock;

  void ask();
  void tick();

  service::Service& service_;
  messaging::Writer<msg::ScanRequest> requests_;
  std::optional<msg::ScanRequest> wanted_;
  std::uint64_t sent_ = 0;
  bool heard_by_nobody_ = false;  // the gateway was not known when the request was sent
  Clock::time_point asked_;
  Clock::time_point since_;    // of the first request for these
  Clock::time_point matched_;  // when somebody took requests last
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::local_mapper
