// The Fast DDS side of a reader.
#pragma once

#include <map>
#include <memory>
#include <set>

#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include "endpoint_shared.hpp"
#include "participant_core.hpp"

namespace topogeo::messaging::detail {

class ReaderListener final : public eprosima::fastdds::dds::DataReaderListener {
 public:
  explicit ReaderListener(std::shared_ptr<Endpoint::Shared> shared) : shared_(std::move(shared)) {}

  void on_subscription_matched(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::SubscriptionMatchedStatus& status) override;
  void on_requested_incompatible_qos(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::RequestedIncompatibleQosStatus& status) override;
  void on_liveliness_changed(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::LivelinessChangedStatus& status) override;
  void on_requested_deadline_missed(
      eprosima::fastdds::dds::DataReader* reader,
      const eprosima::fastdds::dds::RequestedDeadlineMissedStatus& status) override;
  void on_sample_rejected(eprosima::fastdds::dds::DataReader* reader,
                          const eprosima::fastdds::dds::SampleRejectedStatus& status) override;
  void on_sample_lost(eprosima::fastdds::dds::DataReader* reader,
                      const eprosima::fastdds::dds::SampleLostStatus& status) override;

 private:
  std::shared_ptr<Endpoint::Shared> shared_;
};

struct ReaderCore::Impl {
  Impl(std::shared_ptr<ParticipantCore> participant_core, const TopicInfo& topic,
       std::shared_ptr<Endpoint::Shared> shared);
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl();

  /// Keeps `writers` in step with a sample and passes it on.
  void deliver(const eprosima::fastdds::dds::SampleInfo& dds_info, Endpoint::Shared& shared,
               const Handler& handler);

  std::shared_ptr<ParticipantCore> participant;
  const TopicInfo* info;
  ReaderListener listener;
  eprosima::fastdds::dds::TypeSupport type;
  void* message = nullptr;  // reused, so that its vectors keep their memory
  void* empty = nullptr;    // handed over with samples that carry no message
  eprosima::fastdds::dds::ContentFilteredTopic* filtered = nullptr;
  eprosima::fastdds::dds::DataReader* reader = nullptr;
  // Last writer of each instance that is alive, because the middleware does not report which
  // instances a lost writer leaves behind.
  std::map<Handle, Handle> writers;
  std::set<Handle> lost;     // writers that went; messages of theirs may still be waiting here
  std::set<Handle> orphans;  // instances without a writer, still to be reported
};

/// What the event loop needs of a reader.
class LoopAccess {
 public:
  static eprosima::fastdds::dds::DataReader& reader(const ReaderCore& core) {
    return *core.impl_->reader;
  }
  static bool has_orphans(const ReaderCore& core) { return !core.impl_->orphans.empty(); }
};

}  // namespace topogeo::messaging::detail
