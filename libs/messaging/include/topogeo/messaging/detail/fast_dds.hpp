// The names of Fast DDS that differ between 2.9.1 (Debian 12) and 3 (Debian 13). Besides this file,
// type_support.hpp beside it and few files of src/ know both.
#pragma once

#if __has_include(<fastrtps/config.h>)
#define TOPOGEO_FAST_DDS 2
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/common/SerializedPayload.h>
#include <fastdds/rtps/common/Time_t.h>
#include <fastrtps/types/TypesBase.h>
#else
#define TOPOGEO_FAST_DDS 3
#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/core/Time_t.hpp>
#include <fastdds/rtps/common/Guid.hpp>
#include <fastdds/rtps/common/InstanceHandle.hpp>
#include <fastdds/rtps/common/SerializedPayload.hpp>
#ifndef HAVE_SECURITY
#error "Fast DDS 3: HAVE_SECURITY must be defined as in the library (cmake/TopogeoFastDds.cmake)"
#endif
#endif

namespace topogeo::messaging {

#if TOPOGEO_FAST_DDS == 2

namespace rtps = eprosima::fastrtps::rtps;

using DdsDuration = eprosima::fastrtps::Duration_t;
inline bool is_infinite(const DdsDuration& duration) {
  return duration == eprosima::fastrtps::c_TimeInfinite;
}

using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
inline constexpr auto kOk = ReturnCode::RETCODE_OK;
inline constexpr auto kBadParameter = ReturnCode::RETCODE_BAD_PARAMETER;
inline constexpr auto kNoData = ReturnCode::RETCODE_NO_DATA;
inline constexpr auto kPreconditionNotMet = ReturnCode::RETCODE_PRECONDITION_NOT_MET;
inline constexpr auto kTimeout = ReturnCode::RETCODE_TIMEOUT;
inline int number_of(const ReturnCode& code) {
  return static_cast<int>(code());
}

#else

namespace rtps = eprosima::fastdds::rtps;

using DdsDuration = eprosima::fastdds::dds::Duration_t;
inline bool is_infinite(const DdsDuration& duration) {
  return duration == eprosima::fastdds::dds::c_TimeInfinite;
}

using ReturnCode = eprosima::fastdds::dds::ReturnCode_t;
inline constexpr ReturnCode kOk = eprosima::fastdds::dds::RETCODE_OK;
inline constexpr ReturnCode kBadParameter = eprosima::fastdds::dds::RETCODE_BAD_PARAMETER;
inline constexpr ReturnCode kNoData = eprosima::fastdds::dds::RETCODE_NO_DATA;
inline constexpr ReturnCode kPreconditionNotMet =
    eprosima::fastdds::dds::RETCODE_PRECONDITION_NOT_MET;
inline constexpr ReturnCode kTimeout = eprosima::fastdds::dds::RETCODE_TIMEOUT;
inline int number_of(ReturnCode code) {
  return code;
}

#endif

using Payload = rtps::SerializedPayload_t;

}  // namespace topogeo::messaging
