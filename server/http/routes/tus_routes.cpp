#include <sys/socket.h>

#include "core/error.h"
#include "server/http/current_socket.h"
#include "server/http/json_response.h"
#include "server/http/problem.h"
#include "server/http/routes/routes.h"
#include "server/http/tus_fields.h"
#include "server/store/tables/drive_table.h"

namespace parkade {
namespace {

constexpr const char* kVersion = "1.0.0";
constexpr const char* kPartType = "application/offset+octet-stream";
const std::string kUploads = "/api/v1/uploads";

/// Every answer says which protocol it speaks; requests have to, as well.
void BeginTus(const httplib::Request& request, httplib::Response& response) {
  response.set_header("Tus-Resumable", kVersion);
  response.set_header("Cache-Control", "no-store");
  if (request.get_header_value("Tus-Resumable") == kVersion) return;
  response.set_header("Tus-Version", kVersion);
  throw HttpError({412, "unsupported_version", "this address speaks tus 1.0.0: 'Tus-Resumable'"});
}

void RequirePartType(const httplib::Request& request) {
  if (request.get_header_value("Content-Type") != kPartType)
    throw HttpError({415, "unsupported_media_type",
                     std::string("a part of an upload is of the type ") + kPartType});
}

/// How far the upload is, in header fields.
void Describe(const Upload& upload, RouteContext& context, httplib::Response& response) {
  response.set_header("Upload-Offset", std::to_string(upload.offset));
  response.set_header("Upload-Expires", HttpDate(upload.expires_at));
  if (!upload.drive) return;
  response.set_header("Upload-Drive", *upload.drive);
  const auto job = context.store.database.Read(
      [&](Connection& connection) { return FindDriveOrTombstone(connection, *upload.drive).job; });
  if (job) response.set_header("Upload-Job", *job);
}

[[noreturn]] void ThrowRefused(const Upload& upload) {
  throw HttpError({410, upload.error_code.value_or("invalid_input"),
                   upload.error.value_or("the upload was refused")});
}

Upload Append(RouteContext& context, const httplib::Request& request, const std::string& id,
              std::int64_t offset, const httplib::ContentReader& body) {
  RequirePartType(request);
  std::optional<PartChecksum> checksum;
  if (request.has_header("Upload-Checksum"))
    checksum = ParseTusChecksum(request.get_header_value("Upload-Checksum"));
  const std::int64_t bytes =
      ParseTusLength("Content-Length", request.get_header_value("Content-Length"));
  const auto read_part = [&](const std::function<void(std::string_view)>& take) {
    return body([&](const char* data, size_t size) {
      take({data, size});
      context.metrics.upload_bytes += static_cast<std::int64_t>(size);
      return true;
    });
  };
  const auto give_up = [socket = CurrentSocket()] { ::shutdown(socket, SHUT_RD); };
  try {
    return context.uploads.Append(id, offset, bytes, read_part, checksum, give_up);
  } catch (const ChecksumMismatch& mismatch) {
    throw HttpError({460, "checksum_mismatch", mismatch.what()});
  }
}

void Create(RouteContext& context, const httplib::Request& request, httplib::Response& response,
            const httplib::ContentReader& body) {
  BeginTus(request, response);
  Upload upload;
  upload.length = ParseTusLength("Upload-Length", request.get_header_value("Upload-Length"));
  upload.metadata = request.get_header_value("Upload-Metadata");
  std::map<std::string, std::string> metadata = ParseTusMetadata(upload.metadata);
  const auto text = [&](const char* key) -> std::optional<std::string> {
    return metadata[key].empty() ? std::nullopt : std::optional(metadata[key]);
  };
  upload.filename = text("filename").value_or("");
  upload.site = text("site");
  upload.rig = text("rig");
  upload.sha256 = text("sha256");
  Require(!upload.sha256 || IsSha256(*upload.sha256), ErrorCode::kInvalidInput,
          "'sha256' is 64 hexadecimal digits in lower case");
  const bool has_part = request.get_header_value("Content-Length") != "0";
  if (has_part) RequirePartType(request);

  RequireSite(upload.site);
  upload = context.uploads.Create(upload);
  response.set_header("Location", kUploads + "/" + upload.id);
  if (has_part) upload = Append(context, request, upload.id, 0, body);
  Describe(upload, context, response);
  response.status = 201;
}

void Patch(RouteContext& context, const httplib::Request& request, httplib::Response& response,
           const httplib::ContentReader& body) {
  BeginTus(request, response);
  const std::int64_t offset =
      ParseTusLength("Upload-Offset", request.get_header_value("Upload-Offset"));
  Describe(Append(context, request, request.matches[1], offset, body), context, response);
  response.status = 204;
}

void Terminate(RouteContext& context, const httplib::Request& request,
               httplib::Response& response) {
  BeginTus(request, response);
  context.uploads.Terminate(request.matches[1]);
  response.status = 204;
}

/// HEAD is what tus asks for: the client comes back. GET tells people and scripts the same as JSON,
/// while the upload goes on.
void Show(RouteContext& context, const httplib::Request& request, httplib::Response& response) {
  const bool is_head = request.method == "HEAD";
  if (is_head) BeginTus(request, response);
  const std::string id = request.matches[1];
  const Upload upload = is_head ? context.uploads.Find(id) : context.uploads.Look(id);
  Describe(upload, context, response);
  response.set_header("Upload-Length", std::to_string(upload.length));
  if (!upload.metadata.empty()) response.set_header("Upload-Metadata", upload.metadata);
  if (is_head && upload.state == UploadState::kRefused) ThrowRefused(upload);
  SendJson(response, 200, ToJson(upload));
}

}  // namespace

void AddTusRoutes(Router& routes, RouteContext& context) {
  using Request = httplib::Request;
  using Response = httplib::Response;

  const auto say_what_is_spoken = [](const Request&, Response& response) {
    response.set_header("Tus-Resumable", kVersion);
    response.set_header("Tus-Version", kVersion);
    response.set_header("Tus-Extension",
                        "creation,creation-with-upload,termination,checksum,expiration");
    response.set_header("Tus-Checksum-Algorithm", "sha1,sha256");
    response.status = 204;
  };
  routes.On("OPTIONS /api/v1/uploads", say_what_is_spoken);
  routes.On("OPTIONS /api/v1/uploads/{upload}", say_what_is_spoken);
  routes.On("POST /api/v1/uploads", [&context](const Request& request, Response& response,
                                               const httplib::ContentReader& body) {
    Create(context, request, response, body);
  });
  routes.On("GET /api/v1/uploads/{upload}", [&context](const Request& request, Response& response) {
    Show(context, request, response);
  });
  routes.On("PATCH /api/v1/uploads/{upload}", [&context](const Request& request, Response& response,
                                                         const httplib::ContentReader& body) {
    Patch(context, request, response, body);
  });
  routes.On("DELETE /api/v1/uploads/{upload}",
            [&context](const Request& request, Response& response) {
              Terminate(context, request, response);
            });
  // Clients behind a proxy that knows no PATCH.
  routes.On("POST /api/v1/uploads/{upload}", [&context](const Request& request, Response& response,
                                                        const httplib::ContentReader& body) {
    const std::string method = request.get_header_value("X-HTTP-Method-Override");
    if (method == "DELETE") return Terminate(context, request, response);
    if (method == "PATCH") return Patch(context, request, response, body);
    response.set_header("Allow", "GET, HEAD, PATCH, DELETE");
    throw HttpError({405, "method_not_allowed", "parts of an upload are added by PATCH"});
  });
}

}  // namespace parkade
