#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <opencv2/core/utility.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "core/version.h"
#include "server/commands/commands.h"

namespace {

// CONTRACT: 0 done, 1 the input is at fault, 2 usage, 3 our fault.
int ExitStatus(parkade::ErrorCode code) {
  switch (code) {
    case parkade::ErrorCode::kInvalidInput:
    case parkade::ErrorCode::kNotFound: return 1;
    case parkade::ErrorCode::kUsage: return 2;
    case parkade::ErrorCode::kConflict:
    case parkade::ErrorCode::kDiskFull:
    case parkade::ErrorCode::kInternal: return 3;
  }
  return 3;
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // the only threads are ours: core/parallel works on many images at once
  parkade::KeepLinearAlgebraToCaller();
  CLI::App app("Parkade: maps of car parks from recorded drives", "parkade");
  app.set_version_flag("--version", std::string("parkade ") + parkade::kVersion);
  app.require_subcommand(1);
  parkade::Action action;
  parkade::AddMapCommand(app, action);
  parkade::AddServeCommand(app, action);
  parkade::AddInspectCommand(app, action);
  parkade::AddExportCommand(app, action);
  parkade::AddCompareCommand(app, action);
  parkade::AddEvaluateCommand(app, action);
  parkade::AddPoseGraphCommand(app, action);
  parkade::AddSegmentCommand(app, action);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return action();
  } catch (const parkade::Error& error) {
    std::fprintf(stderr, "parkade: %s\n", error.what());
    return ExitStatus(error.code());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "parkade: out of memory\n");
    return 3;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "parkade: internal error: %s\n", error.what());
    return 3;
  }
}
