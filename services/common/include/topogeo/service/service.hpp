// A running service: its participant, event loop, status and the signals that end it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/service_manager.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/messaging/status_publisher.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/service/cpu_watch.hpp"
#include "topogeo/service/metrics_endpoint.hpp"
#include "topogeo/service/service_options.hpp"

namespace topogeo::service {

class DeafnessGuard;
class HealthFile;

/// Selects the messages of a topic that Service::subscribe takes.
struct Subscription {
  std::string role = {};       ///< see messaging::ReaderOptions
  std::string addressee = {};  ///< see messaging::ReaderOptions
  /// See messaging::ReaderOptions; these topics must be subscribed as well.
  std::vector<std::string_view> read_with = {};
  bool any_robot = false;   ///< false: messages of other robots are counted and ignored ...
  bool team = false;        ///< ... except those of robots that share the map
  bool of_map = false;      ///< take those of the robot whose map is used, not the own ones
  bool main_input = false;  ///< the service's main work: its rate and age are in the status
};

/// Thrown by Service::run when the process stood still for so long that peers may have forgotten it
/// (messaging::Participant::stood_still). A program that ends with it is restarted; one that has
/// more to lose than its peers makes another Service.
struct StoodStill final : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One at a time in a process. Readers and writers live as long as the service.
class Service {
 public:
  /// Joins the domain and publishes that the service starts. `any_robot`: it serves every robot and
  /// its status names none. Throws like messaging::Participant and StatusPublisher.
  explicit Service(const Setup& setup, bool any_robot = false);
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  ~Service();

  [[nodiscard]] const Setup& setup() const { return setup_; }
  [[nodiscard]] const std::string& robot_id() const { return setup_.options.robot_id; }
  /// Whether it is one of Setup::options.other_robots.
  [[nodiscard]] bool shares_map(const std::string& robot) const;
  [[nodiscard]] const messaging::Participant& participant() const { return participant_; }
  [[nodiscard]] messaging::EventLoop& loop() { return loop_; }
  [[nodiscard]] messaging::StatusPublisher& status() { return *status_; }
  /// Whether this process gets the CPU time that it needs.
  [[nodiscard]] const CpuWatch& cpu() const { return *cpu_; }

  /// True when a signal has asked the program to end.
  [[nodiscard]] static bool stopping() { return messaging::SignalStop::received() != 0; }

  /// Runs until SIGINT, SIGTERM or loop().stop(). Throws std::logic_error when a subscription has
  /// announced a topic that nothing subscribes to, because a gateway would wait for ever;
  /// StoodStill; Deaf (a std::runtime_error) when the main input is sent but does not arrive. An
  /// exception of a handler sets the state to kServiceFailed with its text and is rethrown here.
  void run();

  /// Calls `handler` in the loop for the messages of T's topic, as handler(message) or
  /// handler(message, info). Messages of another schema version never arrive. std::invalid_argument
  /// from the handler becomes the fault "invalid <topic>", for example "invalid local map".
  /// `on_gone` gets the instances that were disposed or have lost their writer. Throws like
  /// messaging::Reader.
  template <class T, class Handler>
  void subscribe(Handler handler, const Subscription& subscription = {},
                 messaging::EventLoop::InstanceHandler on_gone = {}) {
    note_subscription(messaging::TopicTraits<T>::info(), subscription);
    const messaging::Reader<T> reader(
        participant_, {subscription.role, subscription.addressee, subscription.read_with});
    loop_.add<T>(
        reader,
        [this, handler = std::move(handler), any_robot = subscription.any_robot,
         team = subscription.team, of_map = subscription.of_map,
         main_input = subscription.main_input](const T& message,
                                               const messaging::SampleInfo& info) {
          if (!any_robot && !is_own(message, team, of_map)) return;
          if (main_input)
            status_->count_input(messaging::short_name(messaging::TopicTraits<T>::info()));
          try {
            if constexpr (std::is_invocable_v<const Handler&, const T&,
                                              const messaging::SampleInfo&>) {
              handler(message, info);
            } else {
              handler(message);
            }
          } catch (const std::invalid_argument& error) {
            report_invalid(messaging::TopicTraits<T>::info(), message.sequence_number(),
                           error.what());
            throw messaging::Refused();
          }
        },
        std::move(on_gone));
  }

  /// A writer whose events are watched. Throws like messaging::Writer.
  template <class T>
  messaging::Writer<T> advertise(std::string_view role = {}) {
    messaging::Writer<T> writer(participant_, role);
    loop_.add(writer);
    return writer;
  }

  /// Sends, and retries while the history is full, which counts as fault "send blocked". Returns
  /// false when the program is asked to end before the message could be sent. Throws like
  /// Writer::write.
  template <class T>
  bool send(messaging::Writer<T>& writer, const T& message, std::string_view what) {
    while (!writer.write(message)) {
      if (stopping()) return false;
      report_blocked(what);
    }
    return true;
  }

 private:
  /// Returns false for messages of other robots and counts them as dropped for "other robot".
  template <class T>
  bool is_own(const T& message, bool team, bool of_map) {
    const ServiceOptions& options = setup_.options;
    const bool other_map = of_map && !options.map_robot.empty();
    if (message.robot_id() == (other_map ? options.map_robot : options.robot_id)) return true;
    if (team && shares_map(message.robot_id().to_string())) return true;
    status_->add_drops("other robot");
    return false;
  }

  void note_subscription(const messaging::TopicInfo& topic, const Subscription& subscription);
  void check_subscriptions() const;
  /// Starts the Prometheus endpoint when the options or the configuration ask for it.
  void offer_metrics();
  /// Updates the part of status and service manager that is common to all services.
  void tick();
  void report_blocked(std::string_view what);
  void report_invalid(const messaging::TopicInfo& topic, std::uint64_t sequence_number,
                      std::string_view why);

  Setup setup_;
  messaging::Participant participant_;
  messaging::EventLoop loop_;
  std::optional<messaging::StatusPublisher> status_;
  std::optional<CpuWatch> cpu_;
  std::unique_ptr<DeafnessGuard> deafness_;
  std::optional<messaging::SignalStop> signals_;
  messaging::ServiceManager manager_{loop_};
  std::unique_ptr<HealthFile> health_;
  std::set<std::string_view> subscribed_;
  std::set<std::string_view> announced_;      // topics that have to be subscribed as well
  std::shared_ptr<MetricsEndpoint> metrics_;  // shared with the status, which uses it up to its end
};

}  // namespace topogeo::service
