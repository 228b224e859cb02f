// Applies the settings of a robot's installed services to commands on the same host.
#pragma once

#include <istream>
#include <map>
#include <string>

namespace topogeo::cli {

/// The variables of a file for systemd's EnvironmentFile= (systemd.exec(5)): one NAME=VALUE per
/// line, VALUE optionally in quotes, comments after # or ;. Other lines are ignored.
std::map<std::string, std::string> environment_in(std::istream& file);

/// Takes domain, robot, security and discovery settings from /etc/topogeo/topogeo.env unless the
/// environment sets them, so that an installed command meets the services of its host. Does nothing
/// when the program was not installed or the file does not exist; an unreadable file is reported on
/// stderr.
void take_installed_settings();

}  // namespace topogeo::cli
