// The Fast DDS side of a reader.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include "arrivals.hpp"
#include "endpoint_shared.hpp"
#include "participant_core.hpp"

namespace topogeo::messaging::detail {

/// Takes samples from the middleware for a keep-last reader: when the program takes, or before that
/// when several wait.
class Collector {
 public:
  Collector(eprosima::fastdds::dds::TypeSupport type, std::size_t depth, std::size_t capacity)
      : arrivals(depth, capacity), type_(std::move(type)) {}

  /// Moves the samples that have arrived from the middleware here. Thread-safe.
  void collect(eprosima::fastdds::dds::DataReader& reader);
  /// Waits for the program: true as soon as a sample is there, false after `timeout`.
  bool wait(eprosima::fastdds::dds::DataReader& reader, std::chrono::nanoseconds timeout);
  /// Returns a message for reuse, so that its vectors keep their memory.
  void recycle(std::shared_ptr<void> message);

  Arrivals arrivals;

 private:
  std::shared_ptr<void> spare_message();

  eprosima::fastdds::dds::TypeSupport type_;
  std::mutex mutex_;
  std::vector<std::shared_ptr<void>> spare_;
};

class ReaderListener final : public eprosima::fastdds::dds::DataReaderListener {
 public:
  explicit ReaderListener(std::shared_ptr<Endpoint::Shared> shared) : shared_(std::move(shared)) {}

  /// Call before the reader is made. Null: the program takes samples from the middleware itself.
  void set_collector(std::shared_ptr<Collector> collector) { collector_ = std::move(collector); }

  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override;

  void on_subscription_matched(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) override;
  void on_requested_incompatible_qos(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::RequestedIncompatibleQosStatus& status) override;
  void on_requested_deadline_missed(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::RequestedDeadlineMissedStatus& status) override;
  void on_sample_rejected(eprosima::fastdds::dds::DataReader* reader,
                          const eprosima::fastdds::dds::SampleRejectedStatus& status) override;
  void on_sample_lost(eprosima::fastdds::dds::DataReader* reader,
                      const eprosima::fastdds::dds::SampleLostStatus& status) override;

 private:
  std::shared_ptr<Endpoint::Shared> shared_;
  std::shared_ptr<Collector> collector_;
};

struct ReaderCore::Impl {
  Impl(std::shared_ptr<ParticipantCore> participant_core, const TopicInfo& topic,
       std::shared_ptr<Endpoint::Shared> shared);
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl();

  /// Configures a keep-last reader: the middleware keeps all samples until they are collected.
  void keep_last_of_each_writer(eprosima::fastdds::dds::DataReaderQos& qos);
  void create_reader(const std::string& profile, const std::string& addressee,
                     const std::vector<std::string_view>& read_with);

  /// Takes a sample; false if there is none.
  bool next(Arrival& arrival);
  /// Updates `writers` for a sample and passes it on.
  void deliver(const Arrival& arrival, Endpoint::Shared& shared, const Handler& handler);
  /// Counts and reports a message of a peer that may not write for the robot.
  void deny(const Handle& writer, std::string_view robot) const;
  void end_instance(const SampleInfo& sample, const Handler& handler);
  void note_writer(const SampleInfo& sample);
  /// Removes a writer from `writers`; instances that had no other writer become orphans.
  void lose(const Handle& writer);

  std::shared_ptr<ParticipantCore> participant;
  const TopicInfo* info;
  ReaderListener listener;
  eprosima::fastdds::dds::TypeSupport type;
  std::shared_ptr<void> message;         // reused, so that its vectors keep their memory
  std::shared_ptr<void> empty;           // handed over with samples that carry no message
  std::shared_ptr<Collector> collector;  // null: samples wait in the middleware
  eprosima::fastdds::dds::ContentFilteredTopic* filtered = nullptr;
  eprosima::fastdds::dds::DataReader* reader = nullptr;
  // Living writers of each instance that had a sample of it accepted, because the middleware does
  // not report which instances a lost writer leaves behind. All are kept, so that a peer keeps its
  // instance when a stranger who wrote the same one leaves.
  std::map<Handle, std::set<Handle>> writers;
  std::set<Handle> lost;     // departed writers; some of their messages may still wait here
  std::set<Handle> orphans;  // instances without a writer, to be reported
};

/// Gives the event loop access to a reader.
class LoopAccess {
 public:
  static eprosima::fastdds::dds::DataReader& reader(const ReaderCore& core) {
    return *core.impl_->reader;
  }
  static bool has_orphans(const ReaderCore& core) { return !core.impl_->orphans.empty(); }
};

}  // namespace topogeo::messaging::detail
