#include <limits>
#include <stdexcept>
#include <utility>

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>

#include "corrections.hpp"
#include "endpoint_shared.hpp"
#include "participant_core.hpp"
#include "security.hpp"

namespace topogeo::messaging::detail {

namespace dds = eprosima::fastdds::dds;

namespace {

/// Number of readers whose addressee the writer compares; further readers do it themselves.
constexpr std::size_t kMaxReaderFilters = 256;

class Listener final : public dds::DataWriterListener {
 public:
  explicit Listener(std::shared_ptr<Endpoint::Shared> shared) : shared_(std::move(shared)) {}

  void on_publication_matched(dds::DataWriter* /*writer*/,
                              const dds::PublicationMatchedStatus& status) override {
    shared_->set_matched(status.current_count, status.current_count_change,
                         status.last_subscription_handle);
  }

  void on_offered_incompatible_qos(dds::DataWriter* /*writer*/,
                                   const dds::OfferedIncompatibleQosStatus& status) override {
    shared_->push_incompatible(status);
  }

  void on_offered_deadline_missed(dds::DataWriter* /*writer*/,
                                  const dds::OfferedDeadlineMissedStatus& status) override {
    Event event;
    event.kind = EventKind::kDeadlineMissed;
    event.count = static_cast<int>(status.total_count);
    shared_->push(std::move(event));
  }

 private:
  std::shared_ptr<Endpoint::Shared> shared_;
};

DdsDuration to_duration(std::chrono::nanoseconds duration) {
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(duration.count() / kNanosecondsPerSecond),
          static_cast<std::uint32_t>(duration.count() % kNanosecondsPerSecond)};
}

}  // namespace

struct WriterCore::Impl {
  Impl(std::shared_ptr<ParticipantCore> participant_core, const TopicInfo& topic,
       std::shared_ptr<Endpoint::Shared> shared)
      : participant(std::move(participant_core)), info(&topic), listener(std::move(shared)) {}

  std::shared_ptr<ParticipantCore> participant;
  const TopicInfo* info;
  Listener listener;
  dds::DataWriter* writer = nullptr;
};

WriterCore::WriterCore(const Participant& participant, const TopicInfo& topic,
                       const std::string& role) {
  shared_ = std::make_shared<Shared>(topic.name);
  impl_ = std::make_unique<Impl>(participant.core(), topic, shared_);
  dds::Publisher& publisher = impl_->participant->publisher();
  const std::string profile = profile_name(topic, role, "writer");
  dds::DataWriterQos qos;
  if (publisher.get_datawriter_qos_from_profile(profile, qos) != kOk) {
    throw std::runtime_error("DDS profile '" + profile + "' of topic " + std::string(topic.name) +
                             " is not in the profiles file");
  }
  qos.writer_resource_limits().reader_filters_allocation.maximum = kMaxReaderFilters;
  if (impl_->participant->secured()) use_long_sessions(qos.properties());
  impl_->writer =
      publisher.create_datawriter(&impl_->participant->topic(topic), qos, &impl_->listener);
  if (impl_->writer == nullptr) {
    throw std::runtime_error("DDS: cannot create a writer of topic " + std::string(topic.name) +
                             " with profile '" + profile + "'" +
                             impl_->participant->reason_of_denial());
  }
  if (!topic.addressee.empty()) send_heartbeats_to_addressees(*impl_->writer);
}

WriterCore::~WriterCore() {
  if (impl_->writer == nullptr) return;
  impl_->writer->set_listener(nullptr);
  impl_->participant->publisher().delete_datawriter(impl_->writer);
}

bool WriterCore::write(const void* message) {
  if (const auto defect = impl_->info->find_defect(message)) {
    throw std::invalid_argument(shared_->topic + ": " + *defect);
  }
  // The API takes a mutable pointer but only serializes.
  const auto result = impl_->writer->write(const_cast<void*>(message), dds::HANDLE_NIL);  // NOLINT
  if (result == kOk) {
    ++shared_->messages;
    return true;
  }
  if (result == kTimeout) return false;
  throw std::runtime_error(shared_->topic + ": DDS write failed with code " +
                           std::to_string(number_of(result)));
}

void WriterCore::dispose(const void* message) {
  void* sample = const_cast<void*>(message);  // NOLINT: as in write
  // Unregistering with autodispose (the default) disposes the instance and frees the writer's
  // memory of it, so that ever new ids do not use up max_instances.
  const auto result = impl_->writer->unregister_instance(sample, dds::HANDLE_NIL);
  if (result != kOk && result != kPreconditionNotMet) {
    throw std::runtime_error(shared_->topic + ": DDS dispose failed with code " +
                             std::to_string(number_of(result)));
  }
}

bool WriterCore::wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
  return impl_->writer->wait_for_acknowledgments(to_duration(timeout)) == kOk;
}

std::vector<std::string> WriterCore::read_with(const Handle& reader) const {
  return impl_->participant->read_with(reader);
}

}  // namespace topogeo::messaging::detail
