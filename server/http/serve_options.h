#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/log.h"
#include "server/http/basemap_options.h"
#include "server/jobs/inspect_command.h"
#include "server/jobs/job_limits.h"
#include "server/jobs/job_spec.h"
#include "server/jobs/map_comparer.h"
#include "server/jobs/pictures/picture_desk.h"
#include "server/jobs/slurm/slurm_options.h"
#include "server/webhooks/webhook_sender.h"

namespace parkade {

/// How to serve. The functions stand for what the service leaves to others: it parses no user file
/// itself.
struct ServeOptions {
  std::filesystem::path data = "data";    ///< created where missing; one service at a time
  std::string listen = "127.0.0.1:8080";  ///< HOST:PORT, [IPv6]:PORT; port 0 takes a free one
  bool allow_public = false;              ///< listen on addresses other than loopback, to any Host
  int request_rate = 100;      ///< [1/s] that a token or link may ask in the long run; 0: any
  std::string proxy_host;      ///< name that a proxy on this machine is reached by
  std::string accel_redirect;  ///< its location for files of maps (AccelRedirect); empty: none
  LogLineFormat log_format = LogLineFormat::kText;
  std::optional<bool> access_log;  ///< a line per request; nothing: where the format is JSON
  BasemapOptions basemap;
  std::filesystem::path web_root;  ///< the built viewer; "/" says how to build it where missing
  int num_workers = 1;             ///< how many jobs run at a time
  bool merge_drives = true;        ///< a job maps all drives of its site; false: the new one alone
  std::int64_t disk_reserve = std::int64_t{2} << 30;  ///< [bytes] uploads leave free
  int scrub_days = 7;      ///< [days] within which every stored file is read and compared; 0: never
  int num_threads = 64;    ///< see RequestPools, which has a share for each kind of request
  int drain_seconds = 20;  ///< [s] requests under way may take after SIGTERM

  std::string engine = "local";  ///< what runs jobs: "local", "slurm"
  SlurmOptions slurm;            ///< for the second
  WebhookOptions webhooks;
  JobLimits job_limits;
  JobCommand job_command;          ///< required: the worker of a job
  CompareCommand compare_command;  ///< required: compares two published maps
  InspectCommand inspect_command;  ///< looks at logs that arrive; none: nobody does
  PictureOptions pictures;         ///< how they are read out of logs
  std::function<void(const std::filesystem::path&)>
      check_log;  ///< throws unless the file looks like a drive log
  std::function<void(const std::vector<std::string>& paths)>
      check_paths;  ///< throws unless an archive of files with these paths would be one
  std::function<void(const std::filesystem::path&)>
      check_rig;  ///< throws unless the folder holds a rig
  /// Throws unless these pins (`parkade map --pin`) fit each other and the map in the folder.
  std::function<void(const std::vector<std::string>& pins, const std::filesystem::path& map)>
      check_pins;
};

}  // namespace parkade
