// Locators and transports, whose headers have other names in Fast DDS 2.9.1 and 3.
#pragma once

#include "topogeo/messaging/detail/fast_dds.hpp"

#if TOPOGEO_FAST_DDS == 2
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>
#endif

namespace topogeo::messaging {

using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using rtps::IPLocator;

}  // namespace topogeo::messaging
