#include "security.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fastdds/dds/log/Log.hpp>
#include <unistd.h>

#include "topogeo/support/log.hpp"
#include "topogeo/support/printable.hpp"

#include "corrections.hpp"
#include "endpoint_shared.hpp"
#include "stranger_counts.hpp"
#include "writer_robots.hpp"

namespace topogeo::messaging {

namespace dds = eprosima::fastdds::dds;

namespace {

/// Most refusals kept until they are taken, because strangers can cause any number.
constexpr std::size_t kMaxRefusals = 256;
constexpr std::size_t kMaxPeers = 1024;
/// The handshake has three messages, each sent again every second if it is lost.
constexpr std::chrono::seconds kHandshakeTime{3};

struct SecurityFile {
  const char* property;
  const char* name;
  bool required;
};

constexpr std::array<SecurityFile, 7> kFiles = {{
    {"dds.sec.auth.builtin.PKI-DH.identity_ca", "identity_ca.pem", true},
    {"dds.sec.auth.builtin.PKI-DH.identity_certificate", "certificate.pem", true},
    {"dds.sec.auth.builtin.PKI-DH.private_key", "key.pem", true},
    {"dds.sec.auth.builtin.PKI-DH.identity_crl", "revoked.pem", false},
    {"dds.sec.access.builtin.Access-Permissions.permissions_ca", "permissions_ca.pem", true},
    {"dds.sec.access.builtin.Access-Permissions.governance", "governance.p7s", true},
    {"dds.sec.access.builtin.Access-Permissions.permissions", "permissions.p7s", true},
}};

/// Limits the name and subject that a peer announces, which may have any length.
constexpr std::size_t kMaxNameLength = 128;

/// Denials of this process, the subjects of its peers and the last error of its security plug-ins.
/// Never destroyed: the threads of the middleware may outlive static objects.
struct SecurityErrors {
  std::mutex mutex;
  std::deque<Denial> denials;
  std::map<rtps::GuidPrefix_t, std::string> subjects;  // of authenticated peers
  std::string last;
};

SecurityErrors& security_errors() {
  static auto* const errors = new SecurityErrors;  // NOLINT(cppcoreguidelines-owning-memory)
  return *errors;
}

/// A peer's text, made safe for a log line.
std::string line_of(std::string_view text) {
  return support::printable(text.substr(0, kMaxNameLength));
}

/// Whether the entry is about a denied endpoint of a peer, which security_denials.cpp reports with
/// the name of the peer.
bool is_of_denial(const dds::Log::Entry& entry) {
  const std::string_view function = entry.context.function == nullptr ? "" : entry.context.function;
  return function == "check_remote_datawriter" || function == "check_remote_datareader" ||
         entry.message.starts_with("Error checking create remote") ||
         entry.message.starts_with("Security manager returns an error");
}

class LogForwarder final : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    const std::string category = entry.context.category == nullptr ? "" : entry.context.category;
    if (is_of_denial(entry)) return;
    if (category.starts_with("SECURITY")) {
      // No name here: the RefusalListener reports the refused peer with its name.
      count_security_error();
      SecurityErrors& errors = security_errors();
      const std::lock_guard lock(errors.mutex);
      errors.last = entry.message;
    }
    // Logs once a second at most, because the remains of a departed peer cause a report per packet.
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::seconds(1)) return;
    last_ = now;
    spdlog::warn("DDS: {}: {}", category, entry.message);
  }

 private:
  std::chrono::steady_clock::time_point last_;  // used by the logging thread alone
};

/// Replaces the middleware's own printing, with which a stranger could fill a log.
void forward_log() {
  static const bool done = [] {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<LogForwarder>());
    return true;
  }();
  static_cast<void>(done);
}

/// Empty for a peer that has not shown its certificate.
std::string shown_subject(const rtps::GuidPrefix_t& peer) {
  SecurityErrors& errors = security_errors();
  const std::lock_guard lock(errors.mutex);
  const auto found = errors.subjects.find(peer);
  return found == errors.subjects.end() ? std::string() : line_of(found->second);
}

void forget_subject(const rtps::GuidPrefix_t& peer) {
  SecurityErrors& errors = security_errors();
  const std::lock_guard lock(errors.mutex);
  errors.subjects.erase(peer);
}

std::string text_of(const rtps::GuidPrefix_t& prefix) {
  std::ostringstream text;
  text << prefix;
  return text.str();
}

}  // namespace

void add_security(dds::DomainParticipantQos& qos, const std::filesystem::path& folder) {
  correct_security();
  const char* const servers = std::getenv("ROS_DISCOVERY_SERVER");
  if (servers != nullptr && *servers != '\0') {
    throw std::runtime_error(std::string("DDS security: ROS_DISCOVERY_SERVER is '") + servers +
                             "', but discovery servers of Fast DDS 2.9 carry no security; unset it "
                             "and name the hosts in TOPOGEO_PEERS where there is no multicast");
  }
  forward_log();
  auto& properties = qos.properties().properties();
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  use_long_sessions(qos.properties());
  for (const SecurityFile& file : kFiles) {
    const std::filesystem::path path = std::filesystem::absolute(folder / file.name);
    if (::access(path.c_str(), R_OK) != 0) {
      const std::error_code why(errno, std::generic_category());
      const bool missing = why == std::errc::no_such_file_or_directory;
      if (missing && !file.required) continue;
      throw std::runtime_error(
          "DDS security: cannot read '" + path.string() + "'" +
          (missing ? "; deploy/security/make_keys makes it"
                   : ": " + why.message() + "; it belongs to the user of the services"));
    }
    properties.emplace_back(file.property, "file://" + path.string());
  }
}

void use_long_sessions(rtps::PropertyPolicy& properties) {
  properties.properties().emplace_back("dds.sec.crypto.maxblockspersession", "1048576");
}

void note_denial(Denial denial) {
  SecurityErrors& errors = security_errors();
  const std::lock_guard lock(errors.mutex);
  if (errors.denials.size() == kMaxRefusals) errors.denials.pop_front();
  errors.denials.push_back(std::move(denial));
}

void note_subject(const rtps::GuidPrefix_t& peer, std::string subject) {
  SecurityErrors& errors = security_errors();
  const std::lock_guard lock(errors.mutex);
  errors.subjects[peer] = std::move(subject);
}

std::string last_security_error() {
  dds::Log::Flush();
  SecurityErrors& errors = security_errors();
  const std::lock_guard lock(errors.mutex);
  return errors.last;
}

void RefusalListener::on_peer(const DiscoveredPeer& peer) {
  ReadWithListener::on_peer(peer);
  const rtps::GuidPrefix_t& prefix = peer.id.guidPrefix;
  const std::lock_guard lock(mutex_);
  const auto known = peers_.find(prefix);
  if (peer.gone) {
    writer_robots().depart(detail::to_handle(rtps::InstanceHandle_t(peer.id)));
    if (known == peers_.end()) return;
    report_denials();  // while the name is still known
    if (!known->second.settled) report(prefix, "left before its authentication");
    peers_.erase(known);
    forget_subject(prefix);
  } else if (known == peers_.end() && peers_.size() < kMaxPeers) {
    peers_[prefix] = {line_of(peer.name), line_of(peer.subject), Clock::now()};
  }
}

void RefusalListener::on_authentication(const rtps::GuidPrefix_t& peer, bool authorized) {
  const std::lock_guard lock(mutex_);
  if (!authorized) report(peer, "fails authentication");
  if (const auto known = peers_.find(peer); known != peers_.end()) known->second.settled = true;
}

void RefusalListener::report(const rtps::GuidPrefix_t& prefix, const std::string& what) {
  const auto known = peers_.find(prefix);
  if (refusals_.size() == kMaxRefusals) refusals_.pop_front();
  const Peer peer = known == peers_.end() ? Peer{"unnamed", "", {}} : known->second;
  std::string line = "'" + peer.name + "' (";
  const std::string shown = shown_subject(prefix);
  const std::string& subject = shown.empty() ? peer.subject : shown;
  if (!subject.empty()) line.append(subject).append("; ");
  line.append(text_of(prefix)).append(") ").append(what);
  refusals_.push_back(std::move(line));
}

void RefusalListener::report_denials() {
  std::deque<Denial> denials;
  {
    SecurityErrors& errors = security_errors();
    const std::lock_guard lock(errors.mutex);
    denials.swap(errors.denials);
  }
  for (const Denial& denial : denials) {
    std::string what = denial.writer ? "may not write " : "may not read ";
    what.append(line_of(denial.topic));
    if (!denial.robot.empty())
      what.append(" for robot '").append(line_of(denial.robot)).append("'");
    if (denial.other_governance) what.append(": its governance differs");
    report(denial.peer, what);
  }
}

std::vector<std::string> RefusalListener::take() {
  const std::lock_guard lock(mutex_);
  report_denials();
  for (auto& [prefix, peer] : peers_) {
    if (peer.settled || Clock::now() - peer.since < kHandshakeTime) continue;
    report(prefix, "does not finish authentication");
    peer.settled = true;
  }
  std::vector<std::string> lines(refusals_.begin(), refusals_.end());
  refusals_.clear();
  return lines;
}

}  // namespace topogeo::messaging
