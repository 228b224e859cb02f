#include "topogeo/messaging/participant.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/PublisherQos.hpp>
#include <fastdds/dds/subscriber/qos/SubscriberQos.hpp>

#include "topogeo/messaging/plain_participant.hpp"
#include "topogeo/messaging/revocations.hpp"
#include "topogeo/messaging/same_participant.hpp"
#include "topogeo/messaging/shared_memory.hpp"
#include "topogeo/support/log.hpp"

#include "address_filter.hpp"
#include "corrections.hpp"
#include "endpoint_shared.hpp"
#include "network_names.hpp"
#include "packets/packet_transport.hpp"
#include "participant_core.hpp"
#include "profile_names.hpp"
#include "robot_partitions.hpp"
#include "writer_robots.hpp"

namespace topogeo::messaging {

namespace dds = eprosima::fastdds::dds;

namespace {

constexpr std::uint32_t kMaxDomain = 232;  // the highest whose ports exist

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Loads the profiles once, because the factory that holds them serves the whole process.
void load_profiles(const std::filesystem::path& requested) {
  static std::mutex mutex;
  static std::optional<std::filesystem::path> loaded;

  const std::filesystem::path file =
      requested.empty() ? std::filesystem::path(environment("TOPOGEO_DDS_PROFILES")) : requested;
  const std::lock_guard lock(mutex);
  if (loaded) {
    if (*loaded != file) {
      throw std::runtime_error("DDS profiles: '" + file.string() +
                               "' requested, but this process uses '" + loaded->string() + "'");
    }
    return;
  }
  std::string text = built_in_profiles();
  if (!file.empty()) {
    std::ifstream input(file, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(input), {});
    if (!input || text.empty()) {
      throw std::runtime_error("DDS profiles: cannot read '" + file.string() + "'");
    }
  }
  text = with_names_of_library(std::move(text));
  const auto result = dds::DomainParticipantFactory::get_instance()->load_XML_profiles_string(
      text.data(), text.size());
  if (result != kOk) {
    throw std::runtime_error("DDS profiles: '" + (file.empty() ? "built-in" : file.string()) +
                             "' is not a valid Fast DDS profiles file");
  }
  loaded = file;
  remove_dead_segments();  // once for each process, before it makes its own
}

template <class Entity>
Entity* require(Entity* entity, const std::string& what) {
  if (entity == nullptr) throw std::runtime_error("DDS: cannot create " + what);
  return entity;
}

constexpr const char* kThisHost = "127.0.0.1";

// Adds the hosts to announce oneself to without multicast: addresses or names, separated by ';'. A
// name without an address is left out, because the services of a robot go on without that host. The
// name may be this host's own, so the own address takes its place.
void add_peers(dds::DomainParticipantQos& qos, const std::string& hosts) {
  std::set<std::string> addresses;
  std::istringstream list(hosts);
  for (std::string host; std::getline(list, host, ';');) {
    if (host.empty()) continue;
    const std::set<std::string> found = IPLocator::resolveNameDNS(host).first;
    if (found.empty()) {
      spdlog::warn("TOPOGEO_PEERS: '{}' has no IPv4 address; it is left out until a restart", host);
      addresses.insert(kThisHost);
    }
    addresses.insert(found.begin(), found.end());
  }
  for (const std::string& address : addresses) {
    rtps::Locator_t locator;  // UDP; without a port: the ports of the domain
    IPLocator::setIPv4(locator, address);
    qos.wire_protocol().builtin.initialPeersList.push_back(locator);
  }
  // With any peer given, the middleware leaves the multicast address out.
}

// Adds nodes of ROS 2 on this host, also those without multicast, and by multicast those of the
// network: with any peer given, the middleware leaves the multicast address out, and it takes a
// multicast address without a port for that of a host.
void add_ros_peers(dds::DomainParticipantQos& qos, std::uint32_t domain) {
  constexpr std::uint32_t kFirstPort = 7400;
  constexpr std::uint32_t kPortsOfDomain = 250;
  rtps::Locator_t host;
  IPLocator::setIPv4(host, kThisHost);
  rtps::Locator_t network;
  IPLocator::setIPv4(network, "239.255.0.1");
  network.port = kFirstPort + kPortsOfDomain * domain;
  qos.wire_protocol().builtin.initialPeersList.push_back(host);
  qos.wire_protocol().builtin.initialPeersList.push_back(network);
}

/// Sets the user data without which nodes of ROS 2 do not list a participant.
void set_ros_identity(dds::DomainParticipantQos& qos) {
  constexpr std::string_view kEnclave = "enclave=/;";
  qos.user_data().data_vec({kEnclave.begin(), kEnclave.end()});
}

/// Name of the profile for links between sites.
constexpr std::string_view kBetweenSites = "wan";

// Sends the messages by which secured participants get to know each other in one piece: they carry
// certificates, and Fast DDS 2.9.1 does not finish if those are cut into packets. Other messages
// are not cut either, because each part is encrypted separately, which costs the services of a log
// two thirds more CPU time. Between sites they are, because links may lose packets.
void send_whole_certificates(dds::DomainParticipantQos& qos, bool rest_in_packets) {
  constexpr std::uint32_t kLargestMessage_bytes = 65500;
  for (auto& transport : qos.transport().user_transports) {
    const auto* udp = dynamic_cast<const UDPv4TransportDescriptor*>(transport.get());
    if (udp == nullptr) continue;
    auto whole = std::make_shared<UDPv4TransportDescriptor>(*udp);
    if (rest_in_packets) send_fragments_within(udp->maxMessageSize);
    whole->maxMessageSize = kLargestMessage_bytes;
    transport = std::move(whole);
  }
}

/// Whether a server tells the participant who has left.
bool asks_discovery_server(const dds::DomainParticipantQos& qos) {
  return !environment("ROS_DISCOVERY_SERVER").empty() ||
         qos.wire_protocol().builtin.discovery_config.discoveryProtocol !=
             rtps::DiscoveryProtocol::SIMPLE;
}

std::vector<std::string> secured_partitions(const ParticipantOptions& options,
                                            const std::filesystem::path& keys) {
  try {
    return partitions_by_robot(options.partition, robots_of_keys(keys), options.robots);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("DDS security: '" + keys.string() + "': " + error.what());
  }
}

}  // namespace

ParticipantCore::ParticipantCore(const ParticipantOptions& options) {
  if (options.domain > kMaxDomain) {
    throw std::invalid_argument("DDS domain: " + std::to_string(options.domain) +
                                ", expected 0 to 232");
  }
  correct_fast_dds();
  load_profiles(options.profiles_file);
  std::string profile = options.profile;
  if (profile.empty()) profile = environment("TOPOGEO_DDS_PARTICIPANT");
  if (profile.empty()) profile = "topogeo";

  auto* factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantQos qos;
  if (factory->get_participant_qos_from_profile(profile, qos) != kOk) {
    throw std::runtime_error("DDS participant profile '" + profile +
                             "' is not in the profiles file");
  }
  qos.name(options.name);
  fit_packets(qos);
  const bool ros = is_ros_profile(profile);
  if (ros) {
    add_ros_peers(qos, options.domain);
    set_ros_identity(qos);
  } else {
    add_peers(qos, environment("TOPOGEO_PEERS"));
  }
  std::vector<std::string> partitions;
  if (!ros) partitions.push_back(options.partition);
  std::filesystem::path security = options.security;
  if (security.empty() && !ros) security = environment("TOPOGEO_SECURITY");
  if (!security.empty()) {
    revocations_ = RevocationList(security / options.identity);  // before the middleware reads it
    add_security(qos, security / options.identity);
    partitions = secured_partitions(options, security / options.identity);
    send_whole_certificates(qos, profile == kBetweenSites);
    secured_ = true;
  }
  filter_packets(qos, profile,
                 {.secured = secured_, .believes_removals = asks_discovery_server(qos)});
  const auto& lease = qos.wire_protocol().builtin.discovery_config.leaseDuration;
  freeze_watch_.emplace(longest_freeze(std::chrono::nanoseconds(lease.to_ns()),
                                       environment("TOPOGEO_LONGEST_FREEZE_S")));
  if (options.observe) {
    auto observer = std::make_unique<DiscoveryListener>(secured_);
    observer_ = observer.get();
    refusals_ = secured_ ? observer_ : nullptr;
    listener_ = std::move(observer);
  } else if (secured_) {
    auto refusals = std::make_unique<RefusalListener>();
    refusals_ = refusals.get();
    listener_ = std::move(refusals);
  } else {
    listener_ = std::make_unique<ReadWithListener>();
  }
  participant_ =
      factory->create_participant(options.domain, qos, listener_.get(), dds::StatusMask::none());
  if (participant_ == nullptr && secured()) {
    throw std::runtime_error("DDS security: the material in '" +
                             (security / options.identity).string() + "' was refused" +
                             reason_of_denial());
  }
  static_cast<void>(
      require(participant_, "a participant in domain " + std::to_string(options.domain)));
  try {
    if (participant_->register_content_filter_factory(kAddressFilterClass,
                                                      &AddressFilterFactory::instance()) != kOk) {
      throw std::runtime_error("DDS: cannot register the filter class " +
                               std::string(kAddressFilterClass));
    }
    dds::PublisherQos publisher_qos = dds::PUBLISHER_QOS_DEFAULT;
    for (const std::string& name : partitions) publisher_qos.partition().push_back(name.c_str());
    publisher_ = require(participant_->create_publisher(publisher_qos), "a publisher");
    dds::SubscriberQos subscriber_qos = dds::SUBSCRIBER_QOS_DEFAULT;
    for (const std::string& name : partitions) subscriber_qos.partition().push_back(name.c_str());
    subscriber_ = require(participant_->create_subscriber(subscriber_qos), "a subscriber");
  } catch (...) {
    participant_->delete_contained_entities();
    factory->delete_participant(participant_);
    throw;
  }
}

ParticipantCore::~ParticipantCore() {
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic& ParticipantCore::topic(const TopicInfo& info) {
  const std::lock_guard lock(mutex_);
  if (const auto found = topics_.find(info.name); found != topics_.end()) return *found->second;
  const std::string name(info.name);
  const dds::TypeSupport type(info.make_type());
  if (type.register_type(participant_) != kOk) {
    throw std::runtime_error("DDS: cannot register the type of topic " + name);
  }
  dds::Topic* topic =
      require(participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT),
              "topic " + name);
  topics_.emplace(name, topic);
  return *topic;
}

dds::ContentFilteredTopic& ParticipantCore::make_filtered(const TopicInfo& info,
                                                          const std::string& addressee) {
  if (info.addressee.empty()) {
    throw std::runtime_error("DDS: topic " + std::string(info.name) + ": a reader for '" +
                             addressee + "', but its messages have no addressee");
  }
  dds::Topic& related = topic(info);
  const std::lock_guard lock(mutex_);
  const std::string name = std::string(info.name) + "/filter" + std::to_string(filters_made_++);
  // The filter uses only the parameter; other DDS programs need the expression.
  const std::string expression = std::string(info.addressee) + " = %0";
  return *require(participant_->create_contentfilteredtopic(name, &related, expression, {addressee},
                                                            kAddressFilterClass),
                  "filter '" + expression + "' on topic " + std::string(info.name));
}

void ParticipantCore::remove_filtered(dds::ContentFilteredTopic& topic) {
  participant_->delete_contentfilteredtopic(&topic);
}

bool ParticipantCore::may_write_for(const Handle& writer, std::string_view robot) const {
  if (!secured_ || robot.empty()) return true;
  const Handle own = detail::to_handle(participant_->get_instance_handle());
  return same_participant(writer, own) || writer_robots().allows(writer, robot);
}

std::vector<std::string> ParticipantCore::take_refusals() {
  return refusals_ == nullptr ? std::vector<std::string>{} : refusals_->take();
}

std::optional<std::chrono::nanoseconds> ParticipantCore::stood_still() const {
  return freeze_watch_->stood_still();
}

bool ParticipantCore::take_new_revocations() {
  return revocations_.take_change();
}

std::vector<RemoteEndpoint> ParticipantCore::discovered() const {
  return observer_ == nullptr ? std::vector<RemoteEndpoint>{} : observer_->endpoints();
}

std::size_t ParticipantCore::peers() const {
  return observer_ == nullptr ? 0 : observer_->participants();
}

std::vector<std::string> ParticipantCore::read_with(const Handle& reader) const {
  return listener_->read_with(reader);
}

std::string ParticipantCore::reason_of_denial() const {
  if (!secured()) return {};
  const std::string error = last_security_error();
  return error.empty() ? ": denied by security" : ": denied by security: " + error;
}

Participant::Participant(const ParticipantOptions& options)
    : core_(std::make_shared<ParticipantCore>(options)) {}

std::vector<RemoteEndpoint> Participant::discovered() const {
  return core_->discovered();
}

std::size_t Participant::peers() const {
  return core_->peers();
}

std::vector<std::string> Participant::take_refusals() const {
  return core_->take_refusals();
}

std::optional<std::chrono::nanoseconds> Participant::stood_still() const {
  return core_->stood_still();
}

bool take_new_revocations(const Participant& participant) {
  return participant.core()->take_new_revocations();
}

}  // namespace topogeo::messaging
