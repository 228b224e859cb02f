#include "address_filter.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

namespace topogeo::messaging {

namespace cdr = eprosima::fastcdr;
namespace dds = eprosima::fastdds::dds;

namespace {

cdr::Cdr make_reader(cdr::FastBuffer& buffer) {
#if TOPOGEO_FAST_DDS == 2
  return {buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::Cdr::DDS_CDR};
#else
  return {buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::CdrVersion::XCDRv1};
#endif
}

const char* position_of(cdr::Cdr& message) {
#if TOPOGEO_FAST_DDS == 2
  return message.getCurrentPosition();
#else
  return message.get_current_position();
#endif
}

}  // namespace

bool AddressFilter::evaluate(const SerializedPayload& payload,
                             const FilterSampleInfo& /*sample_info*/,
                             const GUID_t& /*reader_guid*/) const {
  cdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data), payload.length);
  cdr::Cdr message = make_reader(buffer);
  try {
    message.read_encapsulation();
    std::uint32_t length = 0;
    std::uint64_t number = 0;
    message >> length;  // schema_version
    message >> length;  // robot_id
    if (!message.jump(length)) return false;
    message >> number >> number;  // stamp_ns, sequence_number
    message >> length;            // including the terminating zero
    const char* const begin = position_of(message);
    if (length == 0 || !message.jump(length)) return false;
    return std::string_view(begin, std::size_t{length} - 1) == addressee_;
  } catch (const cdr::exception::Exception&) {
    return false;
  }
}

AddressFilterFactory& AddressFilterFactory::instance() {
  static AddressFilterFactory factory;
  return factory;
}

ReturnCode AddressFilterFactory::create_content_filter(const char* /*filter_class_name*/,
                                                       const char* /*type_name*/,
                                                       const dds::TopicDataType* /*data_type*/,
                                                       const char* /*filter_expression*/,
                                                       const ParameterSeq& filter_parameters,
                                                       dds::IContentFilter*& filter) {
  // An update without parameters leaves the filter as it is.
  if (filter != nullptr && filter_parameters.length() == 0) return kOk;
  if (filter_parameters.length() != 1) return kBadParameter;
  dds::IContentFilter* const made = new AddressFilter(filter_parameters[0]);  // NOLINT: theirs
  delete static_cast<AddressFilter*>(filter);                                 // NOLINT: as above
  filter = made;
  return kOk;
}

ReturnCode AddressFilterFactory::delete_content_filter(const char* /*filter_class_name*/,
                                                       dds::IContentFilter* filter) {
  delete static_cast<AddressFilter*>(filter);  // NOLINT: made by create_content_filter
  return kOk;
}

}  // namespace topogeo::messaging
