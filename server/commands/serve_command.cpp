#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/rig.h"
#include "server/commands/commands.h"
#include "server/http/service/serve.h"
#include "server/ingest/files/archive_paths.h"
#include "server/ingest/files/sniff_log.h"
#include "server/pipeline/site_pins.h"

namespace parkade {
namespace {

/// What one job may use, as the command line says it.
struct JobSizes {
  std::int64_t memory_mib = 0;
  int minutes = 24 * 60;
};

std::filesystem::path ThisProgram() { return std::filesystem::read_symlink("/proc/self/exe"); }

/// The viewer beside an installed program, or that of the source tree.
std::filesystem::path FindWebRoot() {
  const std::filesystem::path installed = ThisProgram().parent_path() / "../share/parkade/web";
  return std::filesystem::exists(installed / "index.html")
             ? installed
             : std::filesystem::path(PARKADE_WEB_ROOT);
}

/// The command line of `parkade map` as the worker of one attempt.
std::vector<std::string> WorkerCommand(const JobSpec& spec) {
  // This name leads to the running program even after an upgrade replaced its file.
  std::vector<std::string> command = {"/proc/self/exe", "map"};
  command.insert(command.end(), spec.logs.begin(), spec.logs.end());
  // The site is mapped without a drive that cannot be used; the report names it.
  command.push_back("--skip-bad");
  for (const std::filesystem::path& rig : spec.rigs)
    command.insert(command.end(), {"--rig", rig.empty() ? "-" : rig.string()});
  if (spec.from) command.insert(command.end(), {"--from", *spec.from, "--preview", spec.preview});
  for (const std::string& loop : spec.rejected_loops)
    command.insert(command.end(), {"--reject-loop", loop});
  for (const std::string& loop : spec.forced_loops)
    command.insert(command.end(), {"--force-loop", loop});
  for (const std::string& link : spec.rejected_links)
    command.insert(command.end(), {"--reject-link", link});
  for (const std::string& link : spec.forced_links)
    command.insert(command.end(), {"--force-link", link});
  if (spec.pins && spec.pins->empty()) command.push_back("--no-pins");
  // One word, because a value that begins with a dash would pass for an option.
  for (const std::string& pin : spec.pins.value_or(std::vector<std::string>()))
    command.push_back("--pin=" + pin);
  if (spec.num_threads > 0)
    command.insert(command.end(), {"--threads", std::to_string(spec.num_threads)});
  if (spec.prepared > 0)
    command.insert(command.end(), {"--prepare", std::to_string(spec.prepared)});
  command.insert(command.end(),
                 {"--work", spec.work, "--out", spec.out, "--progress-file", spec.progress});
  return command;
}

std::vector<std::string> ComparisonCommand(const std::filesystem::path& from,
                                           const std::filesystem::path& to,
                                           const std::filesystem::path& out) {
  return {"/proc/self/exe", "compare", from, to, "--out", out};
}

std::vector<std::string> InspectionCommand(const std::filesystem::path& log,
                                           const std::optional<std::filesystem::path>& rig,
                                           const std::filesystem::path& out) {
  std::vector<std::string> command = {"/proc/self/exe", "inspect", log, "--json-file", out};
  if (rig) command.insert(command.end(), {"--rig", *rig});
  return command;
}

std::vector<std::string> PicturesCommand(const std::filesystem::path& log,
                                         const std::optional<std::filesystem::path>& rig,
                                         const std::filesystem::path& index) {
  std::vector<std::string> command = {"/proc/self/exe", "pictures", log, "--index", index};
  if (rig) command.insert(command.end(), {"--rig", *rig});
  return command;
}

void AddLogOptions(CLI::App& command, ServeOptions& options) {
  const std::map<std::string, LogLineFormat> formats = {{"text", LogLineFormat::kText},
                                                        {"json", LogLineFormat::kJson}};
  command.add_option("--log-format", options.log_format, "text, or json: one object per line")
      ->envname("PARKADE_LOG_FORMAT")
      ->transform(CLI::CheckedTransformer(formats).description("text|json"))
      ->default_str("text");
  command.add_option("--access-log", options.access_log,
                     "a line per request: on, off; default: on for json");
}

/// What runs a worker on a node of Slurm's. The name of the file, since a node has no process of
/// ours to be named by; without the mark of one that an upgrade has replaced.
std::vector<std::string> NodeProgram() {
  std::string program = ThisProgram();
  const std::string mark = " (deleted)";
  if (program.ends_with(mark)) program.resize(program.size() - mark.size());
  return {program, kRunAttempt};
}

void AddJobOptions(CLI::App& command, ServeOptions& options, JobSizes& sizes) {
  command.add_option("--engine", options.engine, "what runs jobs: local (this machine) or slurm")
      ->capture_default_str()
      ->check(CLI::IsMember({"local", "slurm"}));
  command.add_option("--slurm-partition", options.slurm.partition,
                     "partition for jobs; default: the cluster's own");
  command.add_option("--workers", options.num_workers, "jobs at a time, or at Slurm at a time")
      ->capture_default_str()
      ->check(CLI::Range(1, 512));
  command
      .add_option("--job-memory", sizes.memory_mib,
                  "[MiB] that a job may use; 0: nine tenths of the machine's. Slurm has to be told")
      ->check(CLI::NonNegativeNumber);
  command.add_option("--job-time", sizes.minutes, "[min] that an attempt at a job may take")
      ->capture_default_str()
      ->check(CLI::Range(1, 60 * 24 * 365));
  command.add_option("--job-cpus", options.slurm.cpus, "processors of a job at Slurm")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
}

void Apply(const JobSizes& sizes, ServeOptions& options) {
  options.job_limits.memory_bytes = sizes.memory_mib << 20;
  options.job_limits.time = std::chrono::minutes(sizes.minutes);
  options.slurm.memory_mib = sizes.memory_mib;
  options.slurm.time = std::chrono::minutes(sizes.minutes);
  options.slurm.node_program = NodeProgram();
}

}  // namespace

void AddServeCommand(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ServeOptions>();
  CLI::App* command = app.add_subcommand("serve", "Run the service: uploads, jobs, maps, viewer");
  command->add_option("--data", options->data, "folder for everything the service keeps")
      ->capture_default_str();
  command->add_option("--listen", options->listen, "HOST:PORT; port 0 takes a free one")
      ->capture_default_str();
  command->add_flag("--allow-public", options->allow_public,
                    "listen on other than loopback addresses, to any Host; needs a token");
  command->add_option("--proxy-host", options->proxy_host,
                      "name that a proxy on this machine is reached by: answer to it as Host, and "
                      "take X-Real-IP for the client's address");
  command->add_option("--accel-redirect", options->accel_redirect,
                      "let nginx send the files of maps, by its internal location of this address "
                      "for the data folder, \"/NAME/\"");
  AddLogOptions(*command, *options);
  command->add_flag("!--separate-drives", options->merge_drives,
                    "map each new drive by itself instead of joining it to its site");
  command->add_option("--web", options->web_root, "folder of the built viewer");
  command->add_option("--basemap", options->basemap.source,
                      "what the viewer draws below sites: a file of PMTiles, or "
                      "\"https://HOST/{z}/{x}/{y}.png\"");
  command->add_option("--basemap-attribution", options->basemap.attribution,
                      "whom the basemap is by");
  command
      ->add_option("--disk-reserve", options->disk_reserve,
                   "bytes of the disk that uploads leave free for maps, \"2GiB\"")
      ->capture_default_str()
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/false))
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--scrub-days", options->scrub_days,
                   "days within which every stored file is read and checked; 0: never")
      ->capture_default_str()
      ->check(CLI::Range(0, 3650));
  command
      ->add_option("--request-rate", options->request_rate,
                   "requests a second that each token may ask in the long run; 0: any")
      ->capture_default_str()
      ->check(CLI::Range(0, 100000));
  command->add_flag("--webhook-private", options->webhooks.limits.allow_private,
                    "webhooks may lead to loopback and private addresses");
  const auto sizes = std::make_shared<JobSizes>();
  AddJobOptions(*command, *options, *sizes);
  command->callback([options, sizes, &action] {
    action = [options, sizes] {
      Apply(*sizes, *options);
      if (options->web_root.empty()) options->web_root = FindWebRoot();
      options->job_command = WorkerCommand;
      options->compare_command = ComparisonCommand;
      options->inspect_command = InspectionCommand;
      options->pictures.command = PicturesCommand;
      options->check_log = CheckLooksLikeLog;
      options->check_paths = [](const std::vector<std::string>& paths) {
        CheckHoldsDrive(paths, "the set");
      };
      options->check_rig = [](const std::filesystem::path& folder) { ReadRig(folder); };
      options->check_pins = [](const std::vector<std::string>& pins,
                               const std::filesystem::path& map) { AnchorPins(pins, map, {}); };
      return Serve(*options);
    };
  });
}

}  // namespace parkade
