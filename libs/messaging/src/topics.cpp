#include "topogeo/messaging/topics.hpp"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <vector>

#include "topogeo/messaging/detail/type_support.hpp"
#include "topogeo/msg/type_supports.h"

#include "bounds.hpp"

namespace topogeo::messaging {

namespace {

/// First allocation for a sample of unknown size, bytes.
constexpr std::uint32_t kInitialPayload = 256;

template <class Generated>
class MessageTypeSupport final : public detail::GrowingTypeSupport<Generated> {
 public:
  MessageTypeSupport() : detail::GrowingTypeSupport<Generated>(kInitialPayload) {}

 protected:
  /// Turns a payload that is no message of the type into one that find_defect() refuses. Otherwise
  /// the middleware would keep the sample and read none behind it, and an exception of the
  /// generated code would end the process (a truth value of 2, an unknown encapsulation).
  bool read(Payload& payload, void* data) override {
    using Message = typename Generated::type;
    try {
      if (detail::GrowingTypeSupport<Generated>::read(payload, data)) return true;
    } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): as the false
    }
    auto& message = *static_cast<Message*>(data);
    message = Message();
    message.schema_version(kUnreadable);
    return true;
  }
};

template <class Generated>
eprosima::fastdds::dds::TopicDataType* make_type() {
  return new MessageTypeSupport<Generated>;  // NOLINT: the caller hands it to a dds::TypeSupport
}

template <class T>
std::optional<std::string> find_defect_of(const void* message) {
  return find_defect(*static_cast<const T*>(message));
}

template <class T>
std::string_view robot_of(const void* message) {
  const auto& robot = static_cast<const T*>(message)->robot_id();
  return {robot.c_str(), robot.size()};
}

template <class T, class TypeSupport>
TopicInfo make_info(std::string_view name, std::string_view role, std::string_view replay_role,
                    std::string_view addressee) {
  return {name,       role, replay_role, addressee, make_type<TypeSupport>, find_defect_of<T>,
          robot_of<T>};
}

}  // namespace

#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee)                             \
  template <>                                                                               \
  const TopicInfo& TopicTraits<msg::Type>::info() {                                         \
    static const TopicInfo topic =                                                          \
        make_info<msg::Type, msg::Type##PubSubType>(k##Type, role, replay_role, addressee); \
    return topic;                                                                           \
  }
#include "topogeo/messaging/topics.def"

std::string_view short_name(const TopicInfo& topic) {
  return topic.name.substr(topic.name.rfind('/') + 1);
}

std::span<const TopicInfo* const> all_topics() {
  static const std::vector<const TopicInfo*> topics = [] {
    std::vector<const TopicInfo*> all = {
#define TOPOGEO_TOPIC(Type, name, role, replay_role, addressee) &TopicTraits<msg::Type>::info(),
#include "topogeo/messaging/topics.def"
    };
    std::ranges::sort(all, {}, [](const TopicInfo* topic) { return topic->name; });
    return all;
  }();
  return topics;
}

}  // namespace topogeo::messaging
