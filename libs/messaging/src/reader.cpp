#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/same_participant.hpp"

#include "read_with.hpp"
#include "reader_impl.hpp"
#include "security.hpp"
#include "stranger_counts.hpp"

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

std::shared_ptr<void> make_message(const dds::TypeSupport& type) {
  return {dds::TypeSupport(type).create_data(),
          [type](void* message) { dds::TypeSupport(type).delete_data(message); }};
}

Arrival make_arrival(const dds::SampleInfo& dds_info, std::shared_ptr<void> message) {
  Arrival arrival;
  SampleInfo& sample = arrival.info;
  sample.valid = dds_info.valid_data;
  sample.state = sample.valid ? InstanceState::kAlive : to_state(dds_info.instance_state);
  sample.instance = to_handle(dds_info.instance_handle);
  sample.writer = to_handle(dds_info.publication_handle);
  sample.stamp_ns = dds_info.source_timestamp.to_ns();
  arrival.number = dds_info.sample_identity.sequence_number().to64long();
  if (sample.valid) arrival.message = std::move(message);
  return arrival;
}

/// The largest limit that the middleware can hold.
constexpr std::int32_t kNoLimit = std::numeric_limits<std::int32_t>::max();
/// Readers of one topic share a pool of 32-bit size, the sum of their limits: room for 60 of them.
constexpr std::int32_t kMostSamples = 1 << 26;

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

void ReaderListener::on_data_available(dds::DataReader* reader) {
  // Bounds the samples that an idle program leaves in the middleware. Collects several at once,
  // because each take searches all samples that wait for a lost one to be sent again.
  constexpr std::uint64_t kMostUncollected = 64;
  if (!collector_) return;
  if (reader->get_unread_count() >= kMostUncollected) collector_->collect(*reader);
  collector_->arrivals.announce();
  shared_->wake_program();
}

void Collector::collect(dds::DataReader& reader) {
  std::vector<Arrival> batch;
  dds::SampleInfo info;
  std::shared_ptr<void> message = spare_message();
  while (!arrivals.is_full(batch.size() + 1) &&
         reader.take_next_sample(message.get(), &info) == kOk) {
    batch.push_back(make_arrival(info, message));
    if (info.valid_data) message = spare_message();
  }
  recycle(std::move(message));
  arrivals.put(std::move(batch));
}

bool Collector::wait(dds::DataReader& reader, std::chrono::nanoseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  do {
    if (arrivals.take_announced()) collect(reader);
    if (arrivals.size() > 0) return true;
  } while (arrivals.wait(end - std::chrono::steady_clock::now()));
  return false;
}

std::shared_ptr<void> Collector::spare_message() {
  {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      auto message = std::move(spare_.back());
      spare_.pop_back();
      return message;
    }
  }
  return make_message(type_);
}

void Collector::recycle(std::shared_ptr<void> message) {
  constexpr std::size_t kMostSpare = 2;  // in use by a loop that keeps up
  const std::lock_guard lock(mutex_);
  if (message && spare_.size() < kMostSpare) spare_.push_back(std::move(message));
}

ReaderCore::Impl::Impl(std::shared_ptr<ParticipantCore> participant_core, const TopicInfo& topic,
                       std::shared_ptr<Endpoint::Shared> shared)
    : participant(std::move(participant_core)),
      info(&topic),
      listener(std::move(shared)),
      type(topic.make_type()),
      message(make_message(type)),
      empty(make_message(type)) {}

ReaderCore::Impl::~Impl() {
  if (reader != nullptr) {
    reader->set_listener(nullptr);
    participant->subscriber().delete_datareader(reader);
  }
  if (filtered != nullptr) participant->remove_filtered(*filtered);
}

void ReaderCore::Impl::keep_last_of_each_writer(dds::DataReaderQos& qos) {
  dds::ResourceLimitsQosPolicy& limits = qos.resource_limits();
  const auto or_no_limit = [](std::int32_t limit) { return limit > 0 ? limit : kNoLimit; };
  const int depth = std::max(1, qos.history().depth);
  collector =
      std::make_shared<Collector>(type, static_cast<std::size_t>(depth),
                                  static_cast<std::size_t>(or_no_limit(limits.max_samples)));
  listener.set_collector(collector);
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  // The middleware refuses a sample if more earlier samples of its writer are missing than fit into
  // an instance, and it requires room for all instances at that size.
  constexpr std::int32_t kMostInstances = 32'768;  // if the profile has no limit
  const std::int32_t instances = limits.max_instances > 0 ? limits.max_instances : kMostInstances;
  limits.max_instances = instances;
  limits.max_samples_per_instance = kMostSamples / instances;
  limits.max_samples = instances * limits.max_samples_per_instance;
}

bool ReaderCore::Impl::next(Arrival& arrival) {
  if (collector) {
    if (collector->arrivals.take_announced()) collector->collect(*reader);
    return collector->arrivals.take(arrival);
  }
  dds::SampleInfo dds_info;
  const auto result = reader->take_next_sample(message.get(), &dds_info);
  if (result == kNoData) return false;
  if (result != kOk) {
    throw std::runtime_error(std::string(info->name) + ": DDS take failed with code " +
                             std::to_string(number_of(result)));
  }
  arrival = make_arrival(dds_info, message);
  return true;
}

void ReaderCore::Impl::deliver(const Arrival& arrival, Endpoint::Shared& shared,
                               const Handler& handler) {
  const SampleInfo& sample = arrival.info;
  if (!sample.valid) {
    end_instance(sample, handler);
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
  if (const auto defect = info->find_defect(arrival.message.get())) {
    refuse(*defect);
    return;
  }
  const std::string_view robot =
      info->robot_of == nullptr ? std::string_view() : info->robot_of(arrival.message.get());
  if (!participant->may_write_for(sample.writer, robot)) {
    deny(sample.writer, robot);
    return;
  }
  ++shared.messages;
  try {
    handler(arrival.message.get(), sample);
    note_writer(sample);
  } catch (const Refused&) {  // NOLINT(bugprone-empty-catch): the handler has reported why
  } catch (const std::invalid_argument& error) {
    // A stranger's message must not end a program that shows a run, or the run (faults_strangers).
    refuse(error.what());
  }
}

void ReaderCore::Impl::deny(const Handle& writer, std::string_view robot) const {
  Denial denial;
  const ParticipantPrefix peer = prefix_of(writer);
  std::ranges::copy(peer, denial.peer.value);
  denial.topic = info->name;
  denial.writer = true;
  denial.robot = robot;
  note_denial(std::move(denial));
  count_denied_sample();
}

void ReaderCore::Impl::note_writer(const SampleInfo& sample) {
  if (!lost.contains(sample.writer)) {
    writers[sample.instance].insert(sample.writer);
    orphans.erase(sample.instance);
  } else if (!writers.contains(sample.instance)) {
    orphans.insert(sample.instance);
  }
}

void ReaderCore::Impl::end_instance(const SampleInfo& sample, const Handler& handler) {
  if (sample.state == InstanceState::kAlive) return;  // a message came after the disposal
  const auto found = writers.find(sample.instance);
  if (found != writers.end()) {
    // A writer without an accepted sample of the instance cannot end a peer's instance.
    if (found->second.erase(sample.writer) == 0) return;
    if (found->second.empty()) writers.erase(found);
  }
  orphans.erase(sample.instance);
  handler(empty.get(), sample);
}

void ReaderCore::Impl::lose(const Handle& writer) {
  for (auto at = writers.begin(); at != writers.end();) {
    auto& [instance, of_instance] = *at;
    if (of_instance.erase(writer) > 0 && of_instance.empty()) {
      orphans.insert(instance);
      at = writers.erase(at);
    } else {
      ++at;
    }
  }
}

void ReaderCore::Impl::create_reader(const std::string& profile, const std::string& addressee,
                                     const std::vector<std::string_view>& read_with) {
  dds::Subscriber& subscriber = participant->subscriber();
  dds::DataReaderQos qos;
  if (subscriber.get_datareader_qos_from_profile(profile, qos) != kOk) {
    throw std::runtime_error("DDS profile '" + profile + "' of topic " + std::string(info->name) +
                             " is not in the profiles file");
  }
  qos.user_data().data_vec(announce_read_with(read_with));
  dds::TopicDescription* description = &participant->topic(*info);
  if (!addressee.empty()) {
    filtered = &participant->make_filtered(*info, addressee);
    description = filtered;
  }
  dds::StatusMask mask = dds::StatusMask::all();
  if (qos.history().kind == dds::KEEP_LAST_HISTORY_QOS) {
    keep_last_of_each_writer(qos);
  } else {
    // A full history holds the writer back, so the program takes the data itself.
    mask >> dds::StatusMask::data_available();
  }
  if (participant->secured()) use_long_sessions(qos.properties());
  reader = subscriber.create_datareader(description, qos, &listener, mask);
  if (reader == nullptr) {
    throw std::runtime_error("DDS: cannot create a reader of topic " + std::string(info->name) +
                             " with profile '" + profile + "'" + participant->reason_of_denial());
  }
  // The collector wakes the program.
  reader->get_statuscondition().set_enabled_statuses(collector ? dds::StatusMask::none()
                                                               : dds::StatusMask::data_available());
}

ReaderCore::ReaderCore(const Participant& participant, const TopicInfo& topic,
                       const std::string& role, const std::string& addressee,
                       const std::vector<std::string_view>& read_with) {
  shared_ = std::make_shared<Shared>(topic.name);
  impl_ = std::make_unique<Impl>(participant.core(), topic, shared_);
  impl_->create_reader(profile_name(topic, role, "reader"), addressee, read_with);
}

ReaderCore::~ReaderCore() = default;

std::size_t ReaderCore::take(std::size_t limit, const Handler& handler) {
  std::size_t taken = 0;
  Arrival arrival;
  while (taken < limit) {
    if (!impl_->next(arrival)) {
      impl_->lost.clear();  // none of their messages waits any more
      break;
    }
    ++taken;
    impl_->deliver(arrival, *shared_, handler);
    if (impl_->collector) impl_->collector->recycle(std::move(arrival.message));
  }
  while (taken < limit && !impl_->orphans.empty()) {
    SampleInfo orphan;
    orphan.state = InstanceState::kNoWriters;
    orphan.instance = impl_->orphans.extract(impl_->orphans.begin()).value();
    ++taken;
    handler(impl_->empty.get(), orphan);
  }
  return taken;
}

bool ReaderCore::wait_for_data(std::chrono::nanoseconds timeout) {
  if (!impl_->orphans.empty()) return true;
  if (impl_->collector) return impl_->collector->wait(*impl_->reader, timeout);
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  return impl_->reader->wait_for_unread_message(
      {static_cast<std::int32_t>(timeout.count() / kNanosecondsPerSecond),
       static_cast<std::uint32_t>(timeout.count() % kNanosecondsPerSecond)});
}

std::uint64_t ReaderCore::waiting() const {
  const std::uint64_t collected = impl_->collector ? impl_->collector->arrivals.size() : 0;
  return collected + impl_->reader->get_unread_count();
}

void ReaderCore::take_events(const EventHandler& handler) {
  Endpoint::take_events([&](const Event& event) {
    if (event.kind == EventKind::kUnmatched) {
      impl_->lost.insert(event.peer);
      impl_->lose(event.peer);
    } else if (event.kind == EventKind::kMatched) {
      impl_->lost.erase(event.peer);
    }
    handler(event);
  });
}

}  // namespace topogeo::messaging::detail
