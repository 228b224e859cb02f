// What `topogeo run` does, for the commands that need it.
#pragma once

#include "service_group.hpp"

namespace topogeo::cli {

/// Maps the log with all services, writes report.json and prints the summary. Returns the exit code
/// (service::kOk or 128 + signal). Throws service::UsageError, service::BadInputError for what
/// cannot be started and std::runtime_error for a run that failed.
int run_log(const RunOptions& options);

/// Adds --workers, --domain, --rate and --profiles.
void add_run_options(CLI::App& app, RunOptions& options);

}  // namespace topogeo::cli
