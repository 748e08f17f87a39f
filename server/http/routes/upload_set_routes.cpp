#include "core/error.h"
#include "server/http/json_response.h"
#include "server/http/routes/json_body.h"
#include "server/http/routes/routes.h"
#include "server/store/tables/drive_table.h"

namespace parkade {
namespace {

constexpr size_t kMaxDeclaration = size_t{5} << 20;  // [bytes] 10,000 parts of long paths fit
const std::string kUploadSets = "/api/v1/upload-sets";

std::vector<UploadPart> PartsIn(const Json& declared) {
  const auto found = declared.find("parts");
  Require(found != declared.end() && found->is_array(), ErrorCode::kInvalidInput,
          "\"parts\" is a list of files, each with \"path\" and \"bytes\"");
  std::vector<UploadPart> parts;
  for (const Json& value : *found) {
    RequireObject(value, "a part", {"path", "bytes", "sha256"});
    parts.push_back({TextIn(value, "path").value_or(""), IntegerIn(value, "bytes").value_or(0),
                     TextIn(value, "sha256")});
  }
  return parts;
}

Json Described(RouteContext& context, const UploadSets::SetWithParts& found) {
  std::optional<std::string> job;
  if (found.set.drive)
    job = context.store.database.Read([&](Connection& connection) {
      return FindDriveOrTombstone(connection, *found.set.drive).job;
    });
  return ToJson(found.set, found.parts, job);
}

void Declare(RouteContext& context, const httplib::ContentReader& body,
             httplib::Response& response) {
  const Json declared = ReadObject(body, {"filename", "site", "rig", "parts"}, kMaxDeclaration);
  UploadSet set;
  set.filename = TextIn(declared, "filename").value_or("");
  set.site = TextIn(declared, "site");
  set.rig = TextIn(declared, "rig");
  std::vector<UploadPart> parts = PartsIn(declared);
  RequireSite(set.site);
  const UploadSets::SetWithParts made = context.uploads.sets().Create(set, std::move(parts));
  response.set_header("Location", kUploadSets + "/" + made.set.id);
  SendJson(response, 201, Described(context, made));
}

}  // namespace

void AddUploadSetRoutes(Router& routes, RouteContext& context) {
  using Request = httplib::Request;
  using Response = httplib::Response;

  routes.On("POST /api/v1/upload-sets",
            [&context](const Request&, Response& response, const httplib::ContentReader& body) {
              Declare(context, body, response);
            });
  routes.On("GET /api/v1/upload-sets/{set}", [&context](const Request& request,
                                                        Response& response) {
    SendJson(response, 200, Described(context, context.uploads.sets().Look(request.matches[1])));
  });
  routes.On("DELETE /api/v1/upload-sets/{set}",
            [&context](const Request& request, Response& response) {
              context.uploads.sets().Terminate(request.matches[1]);
              response.status = 204;
            });
}

}  // namespace parkade
