#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "server/commands/commands.h"
#include "server/store/care/backup.h"

namespace parkade {
namespace {

struct CareArguments {
  std::string data = "data", other;
  bool deep = false;
};

/// Says what was found and returns the exit status: 1 where something is damaged.
int Say(const CareReport& report, const char* what) {
  for (const DamagedFile& file : report.damaged)
    std::printf("%s %s\n", file.path.c_str(), file.damage.c_str());
  std::printf("%lld files, %.3f GB %s: %zu damaged\n", static_cast<long long>(report.files),
              static_cast<double>(report.bytes) * 1e-9, what, report.damaged.size());
  return report.damaged.empty() ? 0 : 1;
}

/// Adds a command that works on a data directory, and `run`s it when it is chosen. Returns it for
/// further options.
CLI::App* AddCareCommand(CLI::App& app, Action& action,
                         const std::shared_ptr<CareArguments>& arguments, const char* name,
                         const char* what, int (*run)(const CareArguments&)) {
  CLI::App* command = app.add_subcommand(name, what);
  command->add_option("--data", arguments->data, "the data directory of the service")
      ->capture_default_str();
  command->callback(
      [arguments, run, &action] { action = [arguments, run] { return run(*arguments); }; });
  return command;
}

}  // namespace

void AddVerifyCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CareArguments>();
  AddCareCommand(
      app, action, arguments, "verify",
      "Whether every stored log, map and rig is there; a service may run meanwhile. Exit status 1 "
      "and a line for each that is damaged",
      [](const CareArguments& chosen) { return Say(VerifyData(chosen.data, chosen.deep), "read"); })
      ->add_flag("--deep", arguments->deep, "read all and compare their SHA-256");
}

void AddBackupCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CareArguments>();
  AddCareCommand(
      app, action, arguments, "backup",
      "Copy a data directory as it is at one moment; a service may run meanwhile. What an earlier "
      "backup there has is not copied again. Exit status 1 where something is damaged",
      [](const CareArguments& chosen) {
        return Say(BackUpData(chosen.data, chosen.other), "copied");
      })
      ->add_option("folder", arguments->other, "where the backup is or will be")
      ->required();
}

void AddRestoreCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CareArguments>();
  AddCareCommand(app, action, arguments, "restore",
                 "Make a data directory of a backup, checking every file that is copied",
                 [](const CareArguments& chosen) {
                   return Say(RestoreData(chosen.other, chosen.data), "copied");
                 })
      ->add_option("folder", arguments->other, "the backup")
      ->required();
}

}  // namespace parkade
