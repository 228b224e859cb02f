// A search worker that misbehaves, for tests: it joins and gets its tasks like a ga_worker.
//   faulty_worker --fault NAME [--domain N] [--partition NAME]
// Its worker id is the name of the fault, a '#' and its process id.
#include <array>
#include <cstdint>
#include <iostream>
#include <limits>
#include <list>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include <unistd.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/detail/type_support.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/matchPubSubTypes.h"
#include "topogeo/msg/status.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::test {
namespace {

enum class Fault : std::uint8_t {
  kNotANumber,      // a pose with NaN
  kUnknownTask,     // right, but with the id of an unknown task
  kManySolutions,   // more solutions than wanted
  kGarbage,         // bytes that cannot be decoded
  kShifted,         // the pose is off by 10 cm, the rest is right
  kEmbellished,     // the right pose with a better score than it has
  kPoorer,          // searches for two generations only
  kOtherVersion,    // has another version
  kOtherMatcher,    // computes differently, as its status shows
  kCopiedWorkerId,  // shows the id of the first other worker that it finds
};

constexpr std::array<std::string_view, 10> kNames = {
    "not_a_number", "unknown_task", "many_solutions", "garbage",       "shifted",
    "embellished",  "poorer",       "other_version",  "other_matcher", "copied_worker_id"};

Fault fault_of(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<Fault>(i);
  }
  throw std::invalid_argument("--fault: '" + std::string(name) + "' is none");
}

/// Sends the valid address of a result, so that it reaches its client, followed by garbage.
class GarbageType final
    : public messaging::detail::GrowingTypeSupport<msg::MatchResultsPubSubType> {
 public:
  GarbageType() : GrowingTypeSupport(1024) {}

 protected:
  bool write(const void* data, messaging::Payload& payload) override {
    if (!GrowingTypeSupport::write(data, payload)) return false;
    constexpr std::uint32_t kAddress = 160;  // larger than any address
    payload.length = kAddress + 40;
    for (std::uint32_t i = kAddress; i < payload.length; ++i) payload.data[i] = 0xFF;
    return true;
  }
};

messaging::TopicInfo garbage_topic() {
  messaging::TopicInfo info = messaging::TopicTraits<msg::MatchResults>::info();
  info.make_type = []() -> eprosima::fastdds::dds::TopicDataType* {
    return new GarbageType;  // NOLINT: the caller hands it to a dds::TypeSupport
  };
  return info;
}

class FaultyWorker {
 public:
  FaultyWorker(const messaging::ParticipantOptions& options, Fault fault, std::string name)
      : fault_(fault),
        participant_(options),
        statuses_in_(participant_),
        statuses_(participant_),
        maps_(participant_),
        garbage_info_(garbage_topic()) {
    if (fault == Fault::kGarbage) {
      garbage_.emplace(participant_, garbage_info_, "");
    } else {
      results_.emplace(participant_);
    }
    loop_.add<msg::LocalMap>(maps_, [this](const msg::LocalMap& map, const auto&) { on_map(map); });
    if (fault == Fault::kCopiedWorkerId) {
      loop_.add<msg::WorkerStatus>(statuses_in_,
                                   [this](const msg::WorkerStatus& status, const auto&) {
                                     if (!tasks_) join(status.worker_id().to_string());
                                   });
    } else {
      join(std::move(name) + "#" + std::to_string(::getpid()));
    }
  }

  messaging::EventLoop& loop() { return loop_; }

 private:
  void join(const std::string& worker_id) {
    tasks_.emplace(participant_, messaging::ReaderOptions{{}, worker_id});
    loop_.add<msg::MatchTasks>(*tasks_, [this](const msg::MatchTasks& message, const auto&) {
      robot_id_ = message.robot_id().to_string();
      client_id_ = message.client_id().to_string();
      for (const msg::MatchTask& task : message.tasks())
        waiting_.push_back(service::from_msg(task));
      answer_waiting();
    });
    messaging::set_header(status_, "", 0, 0);
    messaging::set_worker_id(status_, worker_id);
    messaging::set_text(status_.name(), "faulty", "name");
    messaging::set_text(status_.host(), "nowhere", "host");
    messaging::set_text(status_.version(),
                        fault_ == Fault::kOtherVersion ? "0.0.0-other" : support::kVersion,
                        "version");
    status_.process_id(static_cast<std::uint32_t>(::getpid()));
    status_.slots(1);
    status_.matcher_fingerprint(localization::matcher_fingerprint() +
                                (fault_ == Fault::kOtherMatcher ? 1 : 0));
    constexpr std::chrono::milliseconds kPeriod{200};
    loop_.add_timer(kPeriod, [this] { announce(); });
    announce();
  }

  void announce() {
    // A worker with a copied id announces itself only when tasks can reach it.
    if (fault_ == Fault::kCopiedWorkerId && tasks_->matched() == 0) return;
    if (!statuses_.write(status_)) std::cerr << "status not sent\n";
  }

  void on_map(const msg::LocalMap& map) {
    matcher_.add_map(service::from_msg(map));
    answer_waiting();
  }

  /// Answers tasks that waited for their maps.
  void answer_waiting() {
    for (auto it = waiting_.begin(); it != waiting_.end();) {
      if (matcher_.has_map(it->reference_map_id, it->reference_hash) &&
          matcher_.has_map(it->query_map_id, it->query_hash)) {
        answer(*it);
        it = waiting_.erase(it);
      } else {
        ++it;
      }
    }
  }

  void answer(localization::MatchTask task) {
    constexpr std::uint32_t kFewGenerations = 2;
    constexpr std::uint64_t kFarAway = 1'000'000;
    constexpr double kShift_m = 0.1;
    if (fault_ == Fault::kPoorer) task.genetic.generations = kFewGenerations;
    localization::MatchResult result = matcher_.solve(task);
    if (fault_ == Fault::kUnknownTask) result.task_id += kFarAway;
    if (fault_ == Fault::kShifted || fault_ == Fault::kCopiedWorkerId) {
      result.T_reference_query.x_m += kShift_m;
    }
    if (fault_ == Fault::kEmbellished) {
      result.fitness = 1.0;
      result.verdict = localization::Verdict::kAccepted;
      result.reason = localization::Reason::kNone;
    }
    if (fault_ == Fault::kManySolutions && !result.solutions.empty()) {
      result.solutions.resize(task.solutions_wanted + 1, result.solutions.front());
    }
    service::MatchAddress address;
    address.robot_id = robot_id_;
    address.worker_id = status_.worker_id().to_string();
    address.client_id = client_id_;
    msg::MatchResults out = service::results_for(address);
    out.results().push_back(service::to_msg(result));
    if (fault_ == Fault::kNotANumber) {
      out.results().front().T_reference_query().x_m(std::numeric_limits<double>::quiet_NaN());
    }
    const bool sent = garbage_ ? garbage_->write(&out) : results_->write(out);
    if (!sent) std::cerr << "result not sent\n";
  }

  Fault fault_;
  messaging::Participant participant_;
  messaging::Reader<msg::WorkerStatus> statuses_in_;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Reader<msg::LocalMap> maps_;
  messaging::TopicInfo garbage_info_;
  std::optional<messaging::detail::WriterCore> garbage_;
  std::optional<messaging::Writer<msg::MatchResults>> results_;
  std::optional<messaging::Reader<msg::MatchTasks>> tasks_;
  msg::WorkerStatus status_;
  std::string robot_id_;
  std::string client_id_;  // of the last task
  std::list<localization::MatchTask> waiting_;
  localization::Matcher matcher_;
  messaging::EventLoop loop_;  // last, because it must be destroyed before the readers
};

std::optional<std::string> value_of(std::span<char*> words, std::string_view flag) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == flag) return words[i + 1];
  }
  return {};
}

void run(std::span<char*> words) {
  const std::string fault = value_of(words, "--fault").value_or("");
  messaging::ParticipantOptions options;
  options.domain =
      static_cast<std::uint32_t>(std::stoul(value_of(words, "--domain").value_or("0")));
  options.partition = value_of(words, "--partition").value_or(messaging::kAnyPartition);
  options.name = "faulty worker";
  FaultyWorker worker(options, fault_of(fault), fault);
  const messaging::SignalStop signals([&](int) { worker.loop().stop(); });
  worker.loop().run();
}

}  // namespace
}  // namespace topogeo::test

int main(int argc, char** argv) {
  try {
    topogeo::test::run({argv, static_cast<std::size_t>(argc)});
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "faulty_worker: " << error.what() << '\n';
    return 1;
  }
}
