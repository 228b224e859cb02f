// Prints how a simulated robot moves, a line for each ground truth: milliseconds since 1970, m/s,
// rad/s, collisions so far. Has the flags of a service; ends with SIGTERM.
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "topogeo/msg/simulation.h"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

namespace topogeo::test {
namespace {

void print(const msg::GroundTruth& truth) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  std::cout << std::chrono::duration_cast<std::chrono::milliseconds>(now).count() << ' '
            << std::abs(truth.linear_mps()) << ' ' << std::abs(truth.angular_radps()) << ' '
            << truth.collisions() << std::endl;
}

}  // namespace
}  // namespace topogeo::test

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  return service::run_service(argc, argv, "drive_watch", "Prints how a simulated robot moves.", {},
                              [](const service::Setup& setup) {
                                service::Service service(setup);
                                service.subscribe<msg::GroundTruth>(test::print);
                                service.run();
                              });
}
