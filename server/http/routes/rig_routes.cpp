#include "core/error.h"
#include "server/http/file_response.h"
#include "server/http/json_response.h"
#include "server/http/routes/routes.h"
#include "server/store/rig_store.h"
#include "server/store/tables/rig_table.h"

namespace parkade {
namespace {

std::optional<StoredRig> RigNamed(RouteContext& context, const std::string& name) {
  return context.store.database.Read(
      [&](Connection& connection) { return FindRig(connection, name); });
}

/// The parts of a form, each a file under its own name or that of its field.
RigFiles ReadForm(const httplib::ContentReader& body) {
  RigFiles files;
  std::string* content = nullptr;
  size_t total = 0;
  const bool is_complete = body(
      [&](const httplib::MultipartFormData& part) {
        const std::string name = part.filename.empty() ? part.name : part.filename;
        Require(!files.contains(name), ErrorCode::kInvalidInput,
                "the form holds '" + name + "' twice");
        content = &files[name];
        return true;
      },
      [&](const char* data, size_t size) {
        total += size;
        Require(total <= kMaxRigBytes, ErrorCode::kInvalidInput,
                "the files of a rig have more than 4 MiB");
        if (content != nullptr) content->append(data, size);
        return content != nullptr;
      });
  Require(is_complete, ErrorCode::kInvalidInput, "the form is malformed or broke off");
  return files;
}

}  // namespace

void AddRigRoutes(Router& routes, RouteContext& context) {
  routes.On(
      "GET /api/v1/rigs", [&context](const httplib::Request& request, httplib::Response& response) {
        const Page page = PageOf(request);
        std::vector<StoredRig> rigs = context.store.database.Read(
            [&](Connection& connection) { return ListRigs(connection, WithOneMore(page)); });
        SendPage(response, page, std::move(rigs), [](const StoredRig& rig) { return ToJson(rig); });
      });

  routes.On("PUT /api/v1/rigs/{rig}", [&context](const httplib::Request& request,
                                                 httplib::Response& response,
                                                 const httplib::ContentReader& body) {
    const std::string name = request.matches[1];
    const RigFiles files =
        request.is_multipart_form_data() ? ReadForm(body) : UnpackRig(ReadBody(body, kMaxRigBytes));
    const bool is_new = !RigNamed(context, name);
    const StoredRig rig = StoreRig(context.store, name, files, context.options.check_rig);
    response.set_header("Location", "/api/v1/rigs/" + name);
    SendJson(response, is_new ? 201 : 200, ToJson(rig));
  });

  routes.On("GET /api/v1/rigs/{rig}", [&context](const httplib::Request& request,
                                                 httplib::Response& response) {
    const std::string name = request.matches[1];
    const std::optional<StoredRig> rig = RigNamed(context, name);
    Require(rig.has_value(), ErrorCode::kNotFound, "there is no rig '" + name + "'");
    const std::string etag = '"' + rig->sha256 + '"';
    if (SendNotModified(request, response, etag, "no-cache")) return;
    response.set_header("ETag", etag);
    response.set_header("Cache-Control", "no-cache");
    response.set_header("Content-Disposition", "attachment; filename=\"" + name + ".zip\"");
    response.set_content(ReadRigArchive(context.store, *rig), "application/zip");
  });
}

}  // namespace parkade
