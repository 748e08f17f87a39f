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

void AddDataOption(CLI::App& command, CareArguments& arguments) {
  command.add_option("--data", arguments.data, "the data directory of the service")
      ->capture_default_str();
}

/// Says what was found and returns the exit status: 1 where something is damaged.
int Say(const CareReport& report, const char* what) {
  for (const DamagedFile& file : report.damaged)
    std::printf("%s %s\n", file.path.c_str(), file.damage.c_str());
  std::printf("%lld files, %.3f GB %s: %zu damaged\n", static_cast<long long>(report.files),
              static_cast<double>(report.bytes) * 1e-9, what, report.damaged.size());
  return report.damaged.empty() ? 0 : 1;
}

}  // namespace

void AddVerifyCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CareArguments>();
  CLI::App* command = app.add_subcommand(
      "verify",
      "Whether every stored log, map and rig is there; a service may run meanwhile. Exit status 1 "
      "and a line for each that is damaged");
  AddDataOption(*command, *arguments);
  command->add_flag("--deep", arguments->deep, "read all and compare their SHA-256");
  command->callback([arguments, &action] {
    action = [arguments] { return Say(VerifyData(arguments->data, arguments->deep), "read"); };
  });
}

void AddBackupCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CareArguments>();
  CLI::App* command = app.add_subcommand(
      "backup",
      "Copy a data directory as it is at one moment; a service may run meanwhile. What an earlier "
      "backup there has is not copied again. Exit status 1 where something is damaged");
  AddDataOption(*command, *arguments);
  command->add_option("folder", arguments->other, "where the backup is or will be")->required();
  command->callback([arguments, &action] {
    action = [arguments] { return Say(BackUpData(arguments->data, arguments->other), "copied"); };
  });
}

void AddRestoreCommand(CLI::App& app, Action& action) {
  const auto arguments = std::make_shared<CareArguments>();
  CLI::App* command = app.add_subcommand(
      "restore", "Make a data directory of a backup, checking every file that is copied");
  AddDataOption(*command, *arguments);
  command->add_option("folder", arguments->other, "the backup")->required();
  command->callback([arguments, &action] {
    action = [arguments] { return Say(RestoreData(arguments->other, arguments->data), "copied"); };
  });
}

}  // namespace parkade
