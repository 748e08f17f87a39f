#include "server/commands/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>

#include "core/error.h"
#include "core/version.h"
#include "server/commands/commands.h"

namespace parkade {
namespace {

int ExitStatus(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidInput:
    case ErrorCode::kNotFound: return 1;
    case ErrorCode::kUsage: return 2;
    case ErrorCode::kConflict:
    case ErrorCode::kForbidden:
    case ErrorCode::kDiskFull:
    case ErrorCode::kInternal: return 3;
  }
  return 3;
}

/// The first word, where it names no command.
std::string UnknownCommand(const CLI::App& app, int argc, const char* const* argv) {
  std::string word = argc > 1 ? argv[1] : "";
  const auto is_named = [&](const CLI::App* command) { return command->check_name(word); };
  if (word.empty() || word.front() == '-' || !app.get_subcommands(is_named).empty()) return "";
  return word;
}

}  // namespace

int RunCommandLine(int argc, const char* const* argv) {
  CLI::App app("Parkade: maps of car parks from recorded drives", "parkade");
  app.set_version_flag("--version", std::string("parkade ") + kVersion);
  app.require_subcommand(1);
  Action action;
  AddMapCommand(app, action);
  AddServeCommand(app, action);
  AddRunAttemptCommand(app, action);
  AddVerifyCommand(app, action);
  AddBackupCommand(app, action);
  AddRestoreCommand(app, action);
  AddTokenCommand(app, action);
  AddInspectCommand(app, action);
  AddPicturesCommand(app, action);
  AddConvertCommand(app, action);
  AddExportCommand(app, action);
  AddCompareCommand(app, action);
  AddEvaluateCommand(app, action);
  AddPoseGraphCommand(app, action);
  AddSegmentCommand(app, action);

  if (const std::string word = UnknownCommand(app, argc, argv); !word.empty()) {
    std::fprintf(stderr, "parkade: there is no command '%s', see parkade --help\n", word.c_str());
    return ExitStatus(ErrorCode::kUsage);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return action();
  } catch (const Error& error) {
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

}  // namespace parkade
