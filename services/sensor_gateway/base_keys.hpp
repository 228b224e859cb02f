// The keys of section `base` of the devices file.
#pragma once

#include "device_config.hpp"

namespace topogeo::sensor_gateway {

/// Declares all of them; `base` must outlive the schema.
void describe_base(DeviceFile::Base& base, support::ConfigSchema& schema);

}  // namespace topogeo::sensor_gateway
