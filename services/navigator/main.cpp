// Drives the robot along the routes of the planner.
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "navigator_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  return service::run_service(argc, argv, "navigator",
                              "Drives to goals along the planner's routes.", {},
                              [](const service::Setup& setup) {
                                service::Service service(setup);
                                const navigator::NavigatorService navigator(service);
                                service.run();
                              });
}
