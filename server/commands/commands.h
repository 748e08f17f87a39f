#pragma once

#include <CLI/App.hpp>
#include <functional>

namespace parkade {

/// What a subcommand does once its arguments are parsed; returns the exit status.
using Action = std::function<int()>;

/// The subcommand that a service has Slurm start on its nodes.
constexpr const char* kRunAttempt = "run-attempt";

// Each adds one subcommand to `app` and, when that one is chosen, sets `action`.
void AddMapCommand(CLI::App& app, Action& action);
void AddServeCommand(CLI::App& app, Action& action);
void AddRunAttemptCommand(CLI::App& app, Action& action);
void AddVerifyCommand(CLI::App& app, Action& action);
void AddBackupCommand(CLI::App& app, Action& action);
void AddRestoreCommand(CLI::App& app, Action& action);
void AddTokenCommand(CLI::App& app, Action& action);
void AddInspectCommand(CLI::App& app, Action& action);
void AddPicturesCommand(CLI::App& app, Action& action);
void AddConvertCommand(CLI::App& app, Action& action);
void AddExportCommand(CLI::App& app, Action& action);
void AddCompareCommand(CLI::App& app, Action& action);
void AddEvaluateCommand(CLI::App& app, Action& action);
void AddPoseGraphCommand(CLI::App& app, Action& action);
void AddSegmentCommand(CLI::App& app, Action& action);

}  // namespace parkade
