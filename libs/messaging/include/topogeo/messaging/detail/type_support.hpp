// Type supports made of generated ones, for both versions of Fast DDS.
#pragma once

#include <algorithm>
#include <cstdint>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/messaging/detail/fast_dds.hpp"

#if TOPOGEO_FAST_DDS == 3
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#endif

namespace topogeo::messaging::detail {

/// Payload of a sample in the form that Fast DDS passes it.
template <class Support>
bool write_payload(Support& support, void* message, Payload& payload) {
#if TOPOGEO_FAST_DDS == 2
  return support.serialize(message, &payload);
#else
  return support.serialize(message, payload, eprosima::fastdds::dds::XCDR_DATA_REPRESENTATION);
#endif
}
template <class Support>
bool read_payload(Support& support, Payload& payload, void* message) {
#if TOPOGEO_FAST_DDS == 2
  return support.deserialize(&payload, message);
#else
  return support.deserialize(payload, message);
#endif
}
/// Bytes of the payload of a message, or more.
template <class Support>
std::uint32_t payload_size(Support& support, void* message) {
#if TOPOGEO_FAST_DDS == 2
  return support.get_serialized_size_provider(message)();
#else
  return support.calculate_serialized_size(message,
                                           eprosima::fastdds::dds::XCDR_DATA_REPRESENTATION);
#endif
}

/// The handle of a message's instance; that of none for a type without a key.
inline rtps::InstanceHandle_t make_key(eprosima::fastdds::dds::TypeSupport& support,
                                       void* message) {
  rtps::InstanceHandle_t handle;
#if TOPOGEO_FAST_DDS == 2
  if (support->m_isGetKeyDefined) support.get_key(message, &handle, true);
#else
  if (support->is_compute_key_provided) support.compute_key(message, handle, true);
#endif
  return handle;
}

/// A generated type support whose histories start small and grow with the samples. The generated
/// one makes histories allocate the maximum of a bounded type for each sample, which is 50 MB for a
/// local map. A derived class may read, write, make and delete messages in its own way.
template <class Generated>
class GrowingTypeSupport : public Generated {
 public:
  /// `first_bytes`: first allocation for a sample of unknown size.
  explicit GrowingTypeSupport(std::uint32_t first_bytes) {
#if TOPOGEO_FAST_DDS == 2
    this->m_typeSize = std::min(this->m_typeSize, first_bytes);
#else
    this->max_serialized_type_size = std::min(this->max_serialized_type_size, first_bytes);
#endif
  }

  [[nodiscard]] bool is_bounded() const final {
    return false;
  }

#if TOPOGEO_FAST_DDS == 2
  [[nodiscard]] bool is_plain() const final {
    return false;
  }
  bool serialize(void* data, Payload* payload) final {
    return write(data, *payload);
  }
  bool deserialize(Payload* payload, void* data) final {
    return read(*payload, data);
  }
  void* createData() final {
    return make();
  }
  void deleteData(void* data) final {
    remove(data);
  }

 protected:
  virtual bool write(const void* data, Payload& payload) {
    return Generated::serialize(const_cast<void*>(data), &payload);  // NOLINT: it only reads
  }
  virtual bool read(Payload& payload, void* data) {
    return Generated::deserialize(&payload, data);
  }
  virtual void* make() {
    return Generated::createData();
  }
  virtual void remove(void* data) {
    Generated::deleteData(data);
  }
#else
  using Representation = eprosima::fastdds::dds::DataRepresentationId_t;
  [[nodiscard]] bool is_plain(Representation /*representation*/) const final {
    return false;
  }
  bool serialize(const void* const data, Payload& payload, Representation /*only one*/) final {
    return write(data, payload);
  }
  bool deserialize(Payload& payload, void* data) final {
    return read(payload, data);
  }
  void* create_data() final {
    return make();
  }
  void delete_data(void* data) final {
    remove(data);
  }

 protected:
  virtual bool write(const void* data, Payload& payload) {
    return Generated::serialize(data, payload, eprosima::fastdds::dds::XCDR_DATA_REPRESENTATION);
  }
  virtual bool read(Payload& payload, void* data) {
    return Generated::deserialize(payload, data);
  }
  virtual void* make() {
    return Generated::create_data();
  }
  virtual void remove(void* data) {
    Generated::delete_data(data);
  }
#endif
};

}  // namespace topogeo::messaging::detail
