#include <chrono>

#include "core/error.h"
#include "server/http/file_response.h"
#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/jobs/attempt_folder.h"
#include "server/store/job_queue.h"
#include "server/store/tables/job_table.h"

namespace parkade {
namespace {

Job JobWithId(RouteContext& context, const std::string& id) {
  return context.store.database.Read(
      [&](Connection& connection) { return FindJob(connection, id); });
}

/// The preview of a running job that has one.
std::optional<std::filesystem::path> PreviewOf(RouteContext& context, const Job& job) {
  if (job.state != JobState::kRunning) return std::nullopt;
  const std::filesystem::path file = context.store.directory.PreviewFile(job.id, job.attempt);
  std::error_code missing;
  const bool is_there =
      std::filesystem::is_regular_file(std::filesystem::symlink_status(file, missing));
  return is_there ? std::optional(file) : std::nullopt;
}

/// The entity tag differs for each preview of a job, so that whoever shows one sees that it was
/// replaced.
Json AddressOfPreview(RouteContext& context, const Job& job) {
  const std::optional<std::filesystem::path> file = PreviewOf(context, job);
  std::error_code missing;
  const auto written =
      file ? std::filesystem::last_write_time(*file, missing) : std::filesystem::file_time_type();
  if (!file || missing) return nullptr;
  const auto since = std::chrono::file_clock::to_sys(written).time_since_epoch();
  return "/api/v1/jobs/" + job.id + "/preview.glb?written=" +
         std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(since).count());
}

Json View(RouteContext& context, const Job& job) {
  Json json = ToJson(job, context.jobs.ProgressOf(job.id));
  json["preview"] = AddressOfPreview(context, job);
  return json;
}

std::optional<JobState> StateParameter(const httplib::Request& request) {
  const auto text = QueryParameter(request, "state");
  if (!text) return std::nullopt;
  for (const JobState state : {JobState::kQueued, JobState::kRunning, JobState::kDone,
                               JobState::kFailed, JobState::kCancelled})
    if (*text == ToText(state)) return state;
  throw Error(ErrorCode::kInvalidInput,
              "'state' is one of queued, running, done, failed, cancelled");
}

void SendLog(RouteContext& context, const httplib::Request& request, httplib::Response& response) {
  const Job job = JobWithId(context, request.matches[1]);
  int attempt = job.attempt;
  if (const auto text = QueryParameter(request, "attempt")) {
    const bool is_number =
        text->size() <= 4 && text->find_first_not_of("0123456789") == std::string::npos;
    attempt = is_number ? std::stoi(*text) : -1;
  }
  Require(attempt >= 0 && attempt <= job.attempt, ErrorCode::kNotFound,
          "job '" + job.id + "' has " + std::to_string(job.attempt) + " attempts");
  ServedFile log;
  log.path = context.store.directory.AttemptFolder(job.id, attempt) / AttemptFolder::kLogName;
  log.content_type = "text/plain; charset=utf-8";
  log.cache_control = "no-store";
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(log.path, missing);
  if (missing) {
    response.set_content("", log.content_type);  // no worker was started yet
    return;
  }
  log.bytes = static_cast<std::int64_t>(bytes);
  SendFile(request, response, log);
}

void SendPreview(RouteContext& context, const httplib::Request& request,
                 httplib::Response& response) {
  const std::optional<std::filesystem::path> file =
      PreviewOf(context, JobWithId(context, request.matches[1]));
  std::error_code missing;
  const auto bytes = file ? std::filesystem::file_size(*file, missing) : 0;
  Require(file && !missing, ErrorCode::kNotFound,
          "this job has no preview: none yet, none at all, or its map is there");
  ServedFile preview;
  preview.path = *file;
  preview.bytes = static_cast<std::int64_t>(bytes);
  preview.content_type = "model/gltf-binary";
  preview.cache_control = "no-store";
  SendFile(request, response, preview);
}

}  // namespace

void AddJobRoutes(Router& routes, RouteContext& context) {
  routes.On("GET /api/v1/jobs", [&context](const httplib::Request& request,
                                           httplib::Response& response) {
    const Page page = PageOf(request);
    const auto state = StateParameter(request);
    const auto site = QueryParameter(request, "site");
    std::vector<Job> jobs = context.store.database.Read([&](Connection& connection) {
      return ListJobs(connection, WithOneMore(page), state, site, CurrentCaller().sites);
    });
    SendPage(response, page, std::move(jobs), [&](const Job& job) { return View(context, job); });
  });

  routes.On("GET /api/v1/jobs/{job}",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendJson(response, 200, View(context, JobWithId(context, request.matches[1])));
            });

  routes.On("GET /api/v1/jobs/{job}/log",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendLog(context, request, response);
            });

  routes.On("GET /api/v1/jobs/{job}/preview.glb",
            [&context](const httplib::Request& request, httplib::Response& response) {
              SendPreview(context, request, response);
            });

  routes.On("POST /api/v1/jobs/{job}/cancel",
            [&context](const httplib::Request& request, httplib::Response& response,
                       const httplib::ContentReader&) {
              const std::string id = request.matches[1];
              context.jobs.Cancel(id);
              SendJson(response, 202, View(context, JobWithId(context, id)));
            });

  routes.On("POST /api/v1/jobs/{job}/retry",
            [&context](const httplib::Request& request, httplib::Response& response,
                       const httplib::ContentReader&) {
              const Job job = RetryJob(context.store, request.matches[1]);
              context.events.Publish("job", job.id);
              for (const std::string& drive : job.drives) context.events.Publish("drive", drive);
              context.jobs.Wake();
              SendJson(response, 202, View(context, job));
            });
}

}  // namespace parkade
