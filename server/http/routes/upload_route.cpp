#include "server/http/routes/upload_route.h"

#include "core/error.h"
#include "core/files/sha256.h"
#include "core/log.h"
#include "server/http/json_response.h"
#include "server/http/problem.h"
#include "server/http/routes/routes.h"
#include "server/store/disk/growing_file.h"
#include "server/store/temporary_path.h"

namespace parkade {
namespace {

std::int64_t LengthOf(const httplib::Request& request) {
  return std::stoll(
      request.get_header_value("Content-Length"));  // CheckRequestHead made sure that it is there
}

void Replace(std::string& text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// Streams the body to `log`. Bounded memory: it goes on piece by piece.
void ReceiveBody(const httplib::ContentReader& body, std::int64_t length, GrowingFile& log,
                 Sha256& hash, Metrics& metrics) {
  const bool is_complete = body([&](const char* data, size_t size) {
    log.Append({data, size});
    hash.Add({data, size});
    metrics.upload_bytes += static_cast<std::int64_t>(size);
    return true;
  });
  Require(is_complete && log.size() == length, ErrorCode::kInvalidInput, "the upload broke off");
}

}  // namespace

void CheckLog(const ServeOptions& options, const std::filesystem::path& file,
              const std::string& filename) {
  if (!options.check_log) return;
  try {
    options.check_log(file);
  } catch (const Error& error) {
    const std::string name = filename.empty() ? "the upload" : filename;
    std::string sentence = error.what();
    Replace(sentence, file.string(), name);
    Replace(sentence, file.filename().string(), name);
    if (sentence.find(name) == std::string::npos) sentence = "'" + name + "': " + sentence;
    throw Error(error.code(), sentence);
  }
}

void AnnounceDrive(const ReceivedDrive& received, EventHub& events, JobRunner& jobs,
                   DriveInspector* inspector) {
  events.Publish("drive", received.drive.id);
  events.Publish("job", received.job.id);
  if (inspector != nullptr) inspector->Wake();
  jobs.Wake();
}

NewDrive CheckUpload(const httplib::Request& request, const RouteContext& context) {
  const bool is_form = request.get_header_value("Content-Type").starts_with("multipart/");
  if (is_form)
    throw HttpError(
        {415, "unsupported_media_type", "send the log itself as the body: curl -T FILE"});
  const std::int64_t length = LengthOf(request);
  Require(length > 0, ErrorCode::kInvalidInput, "the upload is empty");
  NewDrive drive;
  drive.filename = QueryParameter(request, "filename").value_or("");
  drive.site = QueryParameter(request, "site");
  drive.rig = QueryParameter(request, "rig");
  RequireSite(drive.site);
  CheckNewDrive(context.store, drive);
  RequireSpace(context.store, length);
  return drive;
}

void AddUploadRoute(Router& routes, RouteContext& context) {
  routes.On("PUT /api/v1/drives", [&context](const httplib::Request& request,
                                             httplib::Response& response,
                                             const httplib::ContentReader& body) {
    const NewDrive drive = CheckUpload(request, context);
    const std::int64_t length = LengthOf(request);
    const TemporaryPath path(context.store.directory.NewTemporaryPath());
    GrowingFile log = GrowingFile::Create(path.get(), length);
    Sha256 hash;
    ReceiveBody(body, length, log, hash, context.metrics);
    log.Finish();
    CheckLog(context.options, path.get(), drive.filename);
    const ReceivedDrive received = ReceiveDrive(
        context.store, drive, {path.get(), length, hash.Finish()}, context.options.merge_drives);

    LogInfo("received drive=" + received.drive.id + " bytes=" + std::to_string(length) +
            " site=" + received.drive.site + " job=" + received.job.id);
    AnnounceDrive(received, context.events, context.jobs, context.inspector);
    response.set_header("Location", "/api/v1/drives/" + received.drive.id);
    SendJson(response, 201,
             {{"drive", ToJson(received.drive)}, {"job", ToJson(received.job, std::nullopt)}});
  });
}

}  // namespace parkade
