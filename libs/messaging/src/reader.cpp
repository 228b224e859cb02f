#include <cstdint>
#include <stdexcept>
#include <utility>

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "read_with.hpp"
#include "reader_impl.hpp"

namespace topogeo::messaging::detail {

namespace dds = eprosima::fastdds::dds;

namespace {

Event make_event(EventKind kind, std::uint32_t count) {
  Event event;
  event.kind = kind;
  event.count = static_cast<int>(count);
  return event;
}

InstanceState to_state(dds::InstanceStateKind state) {
  if (state == dds::ALIVE_INSTANCE_STATE) return InstanceState::kAlive;
  return state == dds::NOT_ALIVE_DISPOSED_INSTANCE_STATE ? InstanceState::kDisposed
                                                         : InstanceState::kNoWriters;
}

}  // namespace

void ReaderListener::on_subscription_matched(dds::DataReader* /*reader*/,
                                             const dds::SubscriptionMatchedStatus& status) {
  shared_->set_matched(status.current_count, status.current_count_change,
                       status.last_publication_handle);
}

void ReaderListener::on_requested_incompatible_qos(
    dds::DataReader* /*reader*/, const dds::RequestedIncompatibleQosStatus& status) {
  shared_->push_incompatible(status);
}

void ReaderListener::on_liveliness_changed(dds::DataReader* /*reader*/,
                                           const dds::LivelinessChangedStatus& status) {
  // A writer that leaves in order also lowers alive_count; it is reported as unmatched.
  if (status.alive_count_change <= 0 && status.not_alive_count_change <= 0) return;
  Event event;
  event.kind =
      status.not_alive_count_change > 0 ? EventKind::kLivelinessLost : EventKind::kLivelinessGained;
  event.peer = to_handle(status.last_publication_handle);
  event.count = status.alive_count;
  shared_->push(std::move(event));
}

void ReaderListener::on_requested_deadline_missed(
    dds::DataReader* /*reader*/, const dds::RequestedDeadlineMissedStatus& status) {
  shared_->push(make_event(EventKind::kDeadlineMissed, status.total_count));
}

void ReaderListener::on_sample_rejected(dds::DataReader* /*reader*/,
                                        const dds::SampleRejectedStatus& status) {
  shared_->push(make_event(EventKind::kSampleRejected, status.total_count));
}

void ReaderListener::on_sample_lost(dds::DataReader* /*reader*/,
                                    const dds::SampleLostStatus& status) {
  shared_->push(make_event(EventKind::kSampleLost, static_cast<std::uint32_t>(status.total_count)));
}

ReaderCore::Impl::Impl(std::shared_ptr<ParticipantCore> participant_core, const TopicInfo& topic,
                       std::shared_ptr<Endpoint::Shared> shared)
    : participant(std::move(participant_core)),
      info(&topic),
      listener(std::move(shared)),
      type(topic.make_type()),
      message(type.create_data()),
      empty(type.create_data()) {}

ReaderCore::Impl::~Impl() {
  if (reader != nullptr) {
    reader->set_listener(nullptr);
    participant->subscriber().delete_datareader(reader);
  }
  if (filtered != nullptr) participant->remove_filtered(*filtered);
  type.delete_data(message);
  type.delete_data(empty);
}

void ReaderCore::Impl::deliver(const dds::SampleInfo& dds_info, Endpoint::Shared& shared,
                               const Handler& handler) {
  SampleInfo sample;
  sample.valid = dds_info.valid_data;
  sample.state = sample.valid ? InstanceState::kAlive : to_state(dds_info.instance_state);
  sample.instance = to_handle(dds_info.instance_handle);
  sample.writer = to_handle(dds_info.publication_handle);
  sample.stamp_ns = dds_info.source_timestamp.to_ns();
  if (!sample.valid) {
    writers.erase(sample.instance);
    orphans.erase(sample.instance);
    handler(empty, sample);
    return;
  }
  const auto refuse = [&](const std::string& why) {
    Event event;
    event.kind = EventKind::kInvalidSample;
    event.peer = sample.writer;
    event.count = 1;
    event.detail = why;
    shared.push(std::move(event));
  };
  if (const auto defect = info->find_defect(message)) {
    refuse(*defect);
    return;
  }
  ++shared.messages;
  if (lost.contains(sample.writer)) {
    orphans.insert(sample.instance);
  } else {
    writers[sample.instance] = sample.writer;
    orphans.erase(sample.instance);
  }
  try {
    handler(message, sample);
  } catch (const std::invalid_argument& error) {
    // No stranger's message ends a program that shows a run, or the run with it (faults_strangers).
    refuse(error.what());
  }
}

ReaderCore::ReaderCore(const Participant& participant, const TopicInfo& topic,
                       const std::string& role, const std::string& addressee,
                       const std::vector<std::string_view>& read_with) {
  shared_ = std::make_shared<Shared>(topic.name);
  impl_ = std::make_unique<Impl>(participant.core(), topic, shared_);
  dds::Subscriber& subscriber = impl_->participant->subscriber();
  const std::string profile = profile_name(topic, role, "reader");
  dds::DataReaderQos qos;
  if (subscriber.get_datareader_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw std::runtime_error("DDS profile '" + profile + "' of topic " + std::string(topic.name) +
                             " is not in the profiles file");
  }
  qos.user_data().data_vec(announce_read_with(read_with));
  dds::TopicDescription* description = &impl_->participant->topic(topic);
  if (!addressee.empty()) {
    impl_->filtered = &impl_->participant->make_filtered(topic, addressee);
    description = impl_->filtered;
  }
  // Data is taken by whoever waits for it; only events come through the listener.
  dds::StatusMask mask = dds::StatusMask::all();
  mask >> dds::StatusMask::data_available();
  if (impl_->participant->secured()) use_long_sessions(qos.properties());
  impl_->reader = subscriber.create_datareader(description, qos, &impl_->listener, mask);
  if (impl_->reader == nullptr) {
    throw std::runtime_error("DDS: cannot create a reader of topic " + std::string(topic.name) +
                             " with profile '" + profile + "'" +
                             impl_->participant->reason_of_denial());
  }
  impl_->reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
}

ReaderCore::~ReaderCore() = default;

std::size_t ReaderCore::take(std::size_t limit, const Handler& handler) {
  std::size_t taken = 0;
  dds::SampleInfo info;
  while (taken < limit) {
    const auto result = impl_->reader->take_next_sample(impl_->message, &info);
    if (result == ReturnCode_t::RETCODE_NO_DATA) {
      impl_->lost.clear();  // nothing of theirs waits any more
      break;
    }
    if (result != ReturnCode_t::RETCODE_OK) {
      throw std::runtime_error(shared_->topic + ": DDS take failed with code " +
                               std::to_string(result()));
    }
    ++taken;
    impl_->deliver(info, *shared_, handler);
  }
  while (taken < limit && !impl_->orphans.empty()) {
    SampleInfo orphan;
    orphan.state = InstanceState::kNoWriters;
    orphan.instance = impl_->orphans.extract(impl_->orphans.begin()).value();
    ++taken;
    handler(impl_->empty, orphan);
  }
  return taken;
}

bool ReaderCore::wait_for_data(std::chrono::nanoseconds timeout) {
  if (!impl_->orphans.empty()) return true;
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  return impl_->reader->wait_for_unread_message(
      {static_cast<std::int32_t>(timeout.count() / kNanosecondsPerSecond),
       static_cast<std::uint32_t>(timeout.count() % kNanosecondsPerSecond)});
}

std::uint64_t ReaderCore::waiting() const {
  return impl_->reader->get_unread_count();
}

void ReaderCore::take_events(const EventHandler& handler) {
  Endpoint::take_events([&](const Event& event) {
    if (event.kind == EventKind::kUnmatched || event.kind == EventKind::kLivelinessLost) {
      impl_->lost.insert(event.peer);
      std::erase_if(impl_->writers, [&](const auto& instance_and_writer) {
        if (instance_and_writer.second != event.peer) return false;
        impl_->orphans.insert(instance_and_writer.first);
        return true;
      });
    } else if (event.kind == EventKind::kMatched || event.kind == EventKind::kLivelinessGained) {
      impl_->lost.erase(event.peer);
    }
    handler(event);
  });
}

}  // namespace topogeo::messaging::detail
