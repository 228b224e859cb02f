// Writes a CARMEN log again with the errors of its odometry multiplied (noisier_odometry.hpp);
// noise.sh maps such logs.
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/noisier_odometry.hpp"

#include "recordings.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;
  command_line::Command app{"a CARMEN log with the errors of its odometry multiplied"};
  std::string log;
  std::string reference;
  std::string out;
  double factor = 1.0;
  scan::CarmenLogOptions options;
  app.add_option("--log", log, "CARMEN log")->required();
  app.add_option("--reference", reference, "reference trajectory of the log, TUM")->required();
  app.add_option("--factor", factor, "1: as recorded")->required();
  app.add_option("--range-max", options.range_max_m, "readings from here on are no returns, metres")
      ->capture_default_str();
  app.add_option("--out", out, "log to write; gzip if it ends in .gz")->required();
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    const bench::Recording recording = bench::recorded(log, reference, options);
    std::vector<geometry::Pose2> odometry;
    for (const scan::Scan& scan : recording.scans) odometry.push_back(scan.T_odom_robot);
    odometry = simulation::noisier_odometry(odometry, recording.T_world_robot, factor);
    scan::CarmenLogWriter writer(out);
    for (std::size_t i = 0; i < odometry.size(); ++i) {
      scan::Scan scan = recording.scans[i];
      scan.T_odom_robot = odometry[i];
      writer.write(scan);
    }
    writer.close();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_noisy_log: %s\n", error.what());
    return 1;
  }
  return 0;
}
