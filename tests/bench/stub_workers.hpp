// Search workers that do all the work of a ga_worker except the search, to measure the rest.
#pragma once

namespace topogeo::bench {

/// The main function of a process with stub workers, each with readers, writers and a worker id of
/// its own. Their answers are right, because the searches are done before the first worker starts.
/// Each answer takes a fixed time, during which the worker is idle; tasks of several clients take
/// turns. Works until SIGTERM. `argv`: --domain N --partition NAME --stub-workers COUNT --cost-us
/// TIME (0: answers at once). Returns an exit code.
int run_stub_workers(int argc, char** argv);

}  // namespace topogeo::bench
