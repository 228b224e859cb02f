// Plans routes on the live hybrid map.
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"

#include "planner_service.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  return service::run_service(argc, argv, "planner", "Answers goals with routes on the map.", {},
                              [](const service::Setup& setup) {
                                service::Service service(setup);
                                const planner::PlannerService planner(service);
                                service.run();
                              });
}
