// Search workers that do everything that a ga_worker does but search, to measure the rest.
#pragma once

namespace topogeo::bench {

/// The main function of a process with stub workers, each with readers, writers and a worker id of
/// its own. Their answers are right: the searches were done before the first of them, and each
/// takes a fixed time, during which the worker does nothing, tasks of several clients in turn.
/// Works until SIGTERM. `argv`: --domain N --partition NAME --stub-workers COUNT --cost-us TIME (0:
/// answers at once). Returns an exit code.
int run_stub_workers(int argc, char** argv);

}  // namespace topogeo::bench
