#include "missing_scans.hpp"

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::local_mapper {
namespace {

constexpr std::chrono::milliseconds kAskPeriod{100};
/// The scans under way come first, which takes a while on a busy machine.
constexpr std::chrono::seconds kSilence{2};
/// A gateway whose scans arrive is soon known as a reader, too. A ROS bridge is no such reader.
constexpr std::chrono::seconds kPatience{10};
/// A log of hours is read up to the scan in a second; a log that is gone never is.
constexpr std::chrono::seconds kLongestAnswer{60};

}  // namespace

MissingScans::MissingScans(service::Service& service)
    : service_(service), requests_(service.advertise<msg::ScanRequest>()) {
  timer_ = service.loop().add_timer(kAskPeriod, [this] { tick(); });
}

MissingScans::~MissingScans() {
  service_.loop().cancel_timer(timer_);
}

bool MissingScans::want(std::uint64_t odometry_epoch, std::uint64_t first) {
  if (!wanted_ || wanted_->odometry_epoch() != odometry_epoch || wanted_->first_scan() != first) {
    wanted_.emplace();
    wanted_->odometry_epoch(odometry_epoch);
    wanted_->first_scan(first);
    since_ = matched_ = Clock::now();
    service_.status().set_waits_for(fmt::format("a resend of scan {} of the log", first));
    spdlog::info("requesting the scans of the log from number {}", first);
    ask();
  }
  const Clock::time_point now = Clock::now();
  if (requests_.matched() > 0) matched_ = now;
  return now - matched_ < kPatience && now - since_ < kLongestAnswer;
}

void MissingScans::found() {
  if (!wanted_) return;
  wanted_.reset();
  service_.status().set_waits_for({});
}

void MissingScans::ask() {
  messaging::set_header(*wanted_, service_.robot_id(), 0, sent_++);
  asked_ = Clock::now();
  heard_by_nobody_ = requests_.matched() == 0;
  static_cast<void>(requests_.write(*wanted_));  // else the timer sends it again
}

void MissingScans::tick() {
  if (!wanted_) return;
  const bool first_reader = heard_by_nobody_ && requests_.matched() > 0;
  if (first_reader || Clock::now() - asked_ >= kSilence) ask();
}

}  // namespace topogeo::local_mapper
