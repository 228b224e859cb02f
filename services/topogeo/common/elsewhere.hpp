// Finds services whose settings differ from those of a command that hears none.
#pragma once

#include <span>
#include <string>

#include "topogeo/messaging/discovery.hpp"

#include "common/domain_view.hpp"
#include "common/host_processes.hpp"

namespace topogeo::cli {

/// The domains and partitions, with the robots, of services that a command with this view does not
/// see: "; services run on domain 3, partition 'topogeo' (robot 'anna')". Empty if there are none.
/// `discovered`: endpoints of the domain of the view; `processes`: services of this host.
std::string services_elsewhere(const DomainView& view,
                               std::span<const messaging::RemoteEndpoint> discovered,
                               std::span<const HostProcess> processes);

}  // namespace topogeo::cli
