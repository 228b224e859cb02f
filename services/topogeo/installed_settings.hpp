// What the settings of the installed services of a robot mean for commands on the same host.
#pragma once

#include <istream>
#include <map>
#include <string>

namespace topogeo::cli {

/// The variables of a file for systemd's EnvironmentFile= (systemd.exec(5)): NAME=VALUE in a line,
/// VALUE perhaps in quotes, comments behind # or ;. Other lines are passed over.
std::map<std::string, std::string> environment_in(std::istream& file);

/// Gives this process what /etc/topogeo/topogeo.env says of domain, robot, security and how
/// services find each other, unless its environment says so itself: an installed command meets the
/// services of its host. Nothing where the program was not installed, or where there is no such
/// file; one that cannot be read is named on stderr.
void take_installed_settings();

}  // namespace topogeo::cli
