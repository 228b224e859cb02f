#include "web/web_run.hpp"

#include <iostream>
#include <optional>
#include <stdexcept>

#include <unistd.h>

#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "run/run_log.hpp"
#include "web/browser.hpp"
#include "web/floor_loader.hpp"

namespace topogeo::cli {
namespace {

class WebRun {
 public:
  WebRun(const RunOptions& options, bool open_browser)
      : open_browser_(open_browser), page_(options.job.out / "logs/web.html"), run_(options) {
    ServiceRun::Hooks hooks;
    hooks.on_tick = [] {};
    hooks.log = [](const std::string& line) { std::cerr << "topogeo: " << line << '\n'; };
    hooks.on_links = [this](const std::string& links, const std::string& without_token) {
      show(links, without_token);
    };
    if (options.simulation && !options.simulation->no_laser) {
      floors_.emplace(run_.participant(), run_.loop(), options, [this](const RunOptions& next) {
        std::cerr << "topogeo: the robot is put into " << next.simulation->world.string() << '\n';
        run_.begin_again(next);
      });
    }
    run_.start(options, std::move(hooks));
  }

  /// Runs until a signal, or until a required service ends.
  void run() {
    run_.run();
    static_cast<void>(run_.stop(true));
    if (run_.signal_number() == 0) throw std::runtime_error(run_.failure());
  }

 private:
  void show(const std::string& links, const std::string& without_token) const {
    // Standard output may be a log that others read instead of a terminal.
    std::cout << (::isatty(STDOUT_FILENO) == 1 ? links : without_token) << "Ctrl-C ends it.\n"
              << std::flush;
    if (open_browser_) open_in_browser(operator_link(links), page_);
  }

  bool open_browser_;
  std::filesystem::path page_;  // leads the browser to the operator's link
  ServiceRun run_;
  std::optional<FloorLoader> floors_;
};

}  // namespace

int run_web(RunOptions options, bool open_browser) {
  if (options.simulation) {
    options.laser = check_inputs(options.job).config.config.local_mapper.T_robot_laser;
    prepare_simulation(options);
  }
  WebRun(options, open_browser).run();
  std::cerr << "topogeo: stopped\n";
  return service::kOk;
}

}  // namespace topogeo::cli
