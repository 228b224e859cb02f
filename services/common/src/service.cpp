#include "topogeo/service/service.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <string>

#include "topogeo/messaging/revocations.hpp"
#include "topogeo/service/health_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/process_resources.hpp"
#include "topogeo/support/version.hpp"

#include "deafness_guard.hpp"

namespace topogeo::service {

namespace {

/// Shorter than the period of the status, so that the status is up to date.
constexpr std::chrono::milliseconds kTick{200};

}  // namespace

Service::Service(const Setup& setup, bool any_robot)
    : setup_(setup), participant_(make_participant(setup.options, setup.name, any_robot)) {
  // Signals first: one that arrives during start-up must end the program cleanly, too.
  signals_.emplace([this](int) { loop_.stop(); });
  status_.emplace(participant_, loop_,
                  messaging::ServiceIdentity{
                      setup.name, setup.instance, any_robot ? "" : robot_id(),
                      std::string(support::kVersion), setup.config.effective.fingerprint});
  cpu_.emplace([this] { return std::chrono::duration<double>(loop_.take_timer_delay()).count(); },
               [this](const char* name, double value) { status_->set_counter(name, value); });
  deafness_ = std::make_unique<DeafnessGuard>(setup_, any_robot, participant_, loop_, *status_);
  health_ = std::make_unique<HealthFile>(HealthFile::folder(), setup_.name);
  health_->update(status_->text());  // a service that hangs before its first tick has a state, too
  loop_.add_timer(kTick, [this] { tick(); });
  offer_metrics();
}

void Service::offer_metrics() {
  const pipeline::MetricsConfig& config = setup_.config.config.metrics;
  const std::string address = setup_.options.metrics_address.value_or(config.address);
  if (setup_.options.metrics_port) {
    metrics_ =
        std::make_shared<MetricsEndpoint>(MetricsAddress{address, *setup_.options.metrics_port, 1});
  } else if (config.port != 0) {
    metrics_ =
        std::make_shared<MetricsEndpoint>(metrics_address(address, config.port, setup_.name));
  } else {
    return;
  }
  spdlog::info("metrics at http://{}:{}/metrics", address, metrics_->port());
  status_->on_publish(
      [endpoint = metrics_](const msg::ServiceStatus& status) { endpoint->update(status); });
}

Service::~Service() {
  status_->set_counter("cpu_s", support::process_cpu_s());
}

bool Service::shares_map(const std::string& robot) const {
  return std::ranges::find(setup_.options.other_robots, robot) != setup_.options.other_robots.end();
}

void Service::note_subscription(const messaging::TopicInfo& topic,
                                const Subscription& subscription) {
  subscribed_.insert(topic.name);
  if (subscription.main_input) status_->set_input(messaging::short_name(topic));
  announced_.insert(subscription.read_with.begin(), subscription.read_with.end());
}

void Service::check_subscriptions() const {
  for (const std::string_view topic : announced_) {
    if (subscribed_.contains(topic)) continue;
    throw std::logic_error("topic " + std::string(topic) +
                           ": read_with names it, but the service does not subscribe to it");
  }
}

void Service::run() {
  check_subscriptions();
  try {
    loop_.run();
  } catch (const StoodStill& error) {
    status_->fault("stood still", error.what());
    throw;
  } catch (const Deaf&) {  // it has reported why
    throw;
  } catch (const std::exception& error) {
    status_->set_state(msg::kServiceFailed, error.what());
    throw;
  }
  spdlog::debug("stopped");
}

void Service::tick() {
  status_->set_counter("cpu_s", support::process_cpu_s());
  status_->set_counter("resident_bytes", static_cast<double>(support::resident_bytes()));
  status_->set_counter("open_files", static_cast<double>(support::open_files()));
  cpu_->tick(support::monotonic_s());
  manager_.show(status_->text() + (cpu_->lasts() ? "; " + cpu_->text() : ""));
  health_->update(status_->text());
  if (const auto still = participant_.stood_still()) {
    throw StoodStill(
        "stood still for " +
        std::to_string(std::chrono::floor<std::chrono::seconds>(*still).count()) +
        " s: peers may have dropped the connection unnoticed; a restart reconnects it");
  }
  deafness_->tick();
  for (const std::string& refusal : participant_.take_refusals()) {
    status_->fault("peer refused", refusal);
  }
  if (messaging::take_new_revocations(participant_)) {
    status_->fault("new revocations",
                   "restart the service: revocations take effect at its next start");
  }
}

void Service::report_blocked(std::string_view what) {
  status_->fault("send blocked", what);
}

void Service::report_invalid(const messaging::TopicInfo& topic, std::uint64_t sequence_number,
                             std::string_view why) {
  std::string name(messaging::short_name(topic));
  std::ranges::replace(name, '_', ' ');
  status_->add_drops("invalid " + name);
  status_->fault("invalid " + name,
                 "number " + std::to_string(sequence_number) + ": " + std::string(why));
}

}  // namespace topogeo::service
