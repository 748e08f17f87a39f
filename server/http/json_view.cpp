#include "server/http/json_view.h"

#include <array>
#include <utility>

namespace parkade {
namespace {

/// JSON text from the store, which our own code wrote.
Json Parsed(const std::optional<std::string>& text) {
  if (!text) return nullptr;
  Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
  return json.is_discarded() ? Json(nullptr) : json;
}

/// Where a job is, or was when it ended without a map.
Json StageOf(const Job& job, const std::optional<JobProgress>& progress) {
  if (progress && !progress->stage.empty()) return progress->stage;
  const bool is_lost = job.state == JobState::kFailed || job.state == JobState::kCancelled;
  return is_lost ? OrNull(job.last_stage) : Json(nullptr);
}

/// Null before an engine has the job. `live`: what only the runner knows.
Json EngineOf(const Job& job, const std::optional<JobProgress>& live) {
  if (!job.place) return nullptr;
  std::optional<std::string> id = job.place->id;
  if (!id && job.place->pid) id = std::to_string(*job.place->pid);
  const bool waits = live && !live->reason.empty();
  return {{"name", job.place->engine},
          {"id", OrNull(id)},
          {"reason", waits ? Json(live->reason) : Json(nullptr)}};
}

Json ChecklistOrNull(const std::optional<std::vector<ChecklistItem>>& items) {
  if (!items) return nullptr;
  Json json = Json::array();
  for (const ChecklistItem& item : *items) json.push_back({{"id", item.id}, {"text", item.text}});
  return json;
}

}  // namespace

Json ToJson(const Drive& drive) {
  return {{"id", drive.id},
          {"name", drive.name},
          {"filename", drive.filename},
          {"site", drive.site},
          {"rig", OrNull(drive.rig)},
          {"state", ToText(drive.state)},
          {"error", OrNull(drive.error)},
          {"bytes", drive.bytes},
          {"sha256", drive.sha256},
          {"streams", Parsed(drive.streams)},
          {"inspection", OrNull(drive.inspection_state)},
          {"job", OrNull(drive.job)},
          {"map_version", OrNull(drive.map_version)},
          {"created_at", drive.created_at},
          {"log", drive.log_deleted_at ? "deleted" : "stored"},
          {"log_deleted_at", OrNull(drive.log_deleted_at)},
          {"updated_at", drive.updated_at}};
}

Json ToJson(const Upload& upload) {
  return {{"id", upload.id},
          {"filename", upload.filename},
          {"site", OrNull(upload.site)},
          {"rig", OrNull(upload.rig)},
          {"state", ToText(upload.state)},
          {"error", OrNull(upload.error)},
          {"error_code", OrNull(upload.error_code)},
          {"length", upload.length},
          {"offset", upload.offset},
          {"drive", OrNull(upload.drive)},
          {"set", OrNull(upload.set)},
          {"created_at", upload.created_at},
          {"expires_at", upload.expires_at}};
}

Json ToJson(const UploadSet& set, const std::vector<Upload>& parts,
            const std::optional<std::string>& job) {
  Json json = {{"id", set.id},
               {"filename", set.filename},
               {"site", OrNull(set.site)},
               {"rig", OrNull(set.rig)},
               {"state", ToText(set.state)},
               {"error", OrNull(set.error)},
               {"error_code", OrNull(set.error_code)},
               {"bytes", set.bytes},
               {"drive", OrNull(set.drive)},
               {"job", OrNull(job)},
               {"created_at", set.created_at},
               {"expires_at", set.expires_at},
               {"parts", Json::array()}};
  for (const Upload& part : parts)
    json["parts"].push_back({{"path", part.path.value_or("")},
                             {"bytes", part.length},
                             {"offset", part.offset},
                             {"upload", "/api/v1/uploads/" + part.id}});
  return json;
}

void AddTrajectories(const Drive& drive, const MapVersion& map, Json& json) {
  Json links = Json::object();
  const std::string folder = drive.name + "/";
  for (const MapFile& file : map.files)
    if (file.name.starts_with(folder))
      links[file.name.substr(folder.size())] = MapAddress(map.site, map.version) + "/" + file.name;
  json["trajectories"] = links;
}

Json ToJson(const Job& job, const std::optional<JobProgress>& live_progress) {
  const bool is_done = job.state == JobState::kDone;
  // A job that has just ended may still have its last progress.
  const std::optional<JobProgress> progress =
      job.state == JobState::kRunning ? live_progress : std::nullopt;
  return {
      {"id", job.id},
      {"site", job.site},
      {"drives", job.drives},
      {"state", ToText(ShownState(job))},
      {"stage", StageOf(job, progress)},
      {"progress", progress  ? progress->progress
                   : is_done ? 1.0
                             : 0.0},
      {"eta_seconds", progress ? OrNull(progress->eta_seconds) : Json(nullptr)},
      {"attempts", job.attempt},
      {"engine", EngineOf(job, progress)},
      {"error", OrNull(job.error)},
      {"error_code", OrNull(job.error_code)},
      {"not_before", OrNull(job.not_before)},
      {"map_version", OrNull(job.map_version)},
      {"created_at", job.created_at},
      {"started_at", ShownState(job) == JobState::kQueued ? Json(nullptr) : OrNull(job.started_at)},
      {"finished_at", OrNull(job.finished_at)}};
}

Json ToJson(const StoredRig& rig) {
  return {{"name", rig.name},
          {"files", rig.files},
          {"sha256", rig.sha256},
          {"created_at", rig.created_at}};
}

Json ToJson(const Site& site) {
  return {{"name", site.name},
          {"datum", Parsed(site.datum)},
          {"bounds", Parsed(site.bounds)},
          {"versions", site.versions},
          {"latest_version", site.versions.empty() ? Json(nullptr) : Json(site.versions.back())},
          {"approved_version", OrNull(site.approved_version)},
          {"review_state", site.review_state ? Json(ToText(*site.review_state)) : Json(nullptr)},
          {"drive_count", site.num_drives},
          {"title", site.title},
          {"note", site.note},
          {"retention", {{"log_days", OrNull(site.log_days)}, {"map_days", OrNull(site.map_days)}}},
          {"default_rig", OrNull(site.default_rig)},
          {"review_checklist", ChecklistOrNull(site.review_checklist)},
          {"created_at", site.created_at}};
}

Json ToJson(const MapVersion& map, bool with_files) {
  const std::string address = MapAddress(map.site, map.version);
  Json json = {{"site", map.site},
               {"version", map.version},
               {"job", map.job},
               {"sha256", map.sha256},
               {"datum", Parsed(map.datum)},
               {"bounds", Parsed(map.bounds)},
               {"created_at", map.created_at},
               {"url", address}};
  if (!with_files) {
    // A version with its files is cached for ever; this changes.
    json["review_state"] = ToText(map.review_state);
    json["files_deleted_at"] = OrNull(map.files_deleted_at);
    return json;
  }
  json["drives"] = Json::array();
  for (const Drive& drive : map.drives)
    json["drives"].push_back({{"id", drive.id}, {"name", drive.name}});
  json["files"] = Json::array();
  for (const MapFile& file : map.files)
    json["files"].push_back({{"name", file.name},
                             {"bytes", file.bytes},
                             {"sha256", file.sha256},
                             {"content_type", ContentTypeOf(file.name)},
                             {"url", address + "/" + file.name}});
  return json;
}

std::string MapAddress(const std::string& site, std::int64_t version) {
  return "/api/v1/sites/" + site + "/maps/" + std::to_string(version);
}

const char* ContentTypeOf(const std::string& filename) {
  constexpr std::array<std::pair<const char*, const char*>, 25> kTypes = {{
      {".glb", "model/gltf-binary"},
      {".geojson", "application/geo+json"},
      {".json", "application/json"},
      {".ply", "application/octet-stream"},
      {".tum", "text/plain; charset=utf-8"},
      {".csv", "text/csv; charset=utf-8"},
      {".txt", "text/plain; charset=utf-8"},
      {".pgw", "text/plain; charset=utf-8"},
      {".yaml", "application/yaml"},
      {".kml", "application/vnd.google-earth.kml+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".tif", "image/tiff"},
      {".tiff", "image/tiff"},
      {".svg", "image/svg+xml"},
      {".ico", "image/x-icon"},
      {".webmanifest", "application/manifest+json"},
      {".html", "text/html; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".wasm", "application/wasm"},
      {".woff2", "font/woff2"},
      {".map", "application/json"},
      {".webp", "image/webp"},
  }};
  for (const auto& [extension, type] : kTypes)
    if (filename.ends_with(extension)) return type;
  return "application/octet-stream";
}

}  // namespace parkade
