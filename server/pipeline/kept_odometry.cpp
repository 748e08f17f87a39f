#include "server/pipeline/kept_odometry.h"

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files/file.h"
#include "core/files/sha256.h"
#include "core/log.h"
#include "core/options_json.h"
#include "core/version.h"
#include "server/map_folder/odometry_fingerprint.h"
#include "slam/odometry/odometry_file.h"
#include "slam/sessions/stage_results.h"

namespace parkade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOdometryFile = "odometry.bin";
constexpr const char* kInputsFile = "odometry.key";  // beside it, in folders for a next try
constexpr std::size_t kMaxKeyBytes = 64;

std::string TrackedBy(const RecordedDrive& log, const BuildContext& context) {
  return OdometryFingerprint({{"odometry", OptionsToJson(context.options.odometry)}},
                             HealthToJson(log.health()).at("streams"));
}

/// The log's SHA-256; empty where it is not known.
std::string HashOf(const RecordedDrive& log, const BuildScope& scope) {
  const auto found = scope.logs.find(log.name());
  return found == scope.logs.end() ? "" : found->second;
}

/// All that this build's odometry depends on but the rig, which the file itself knows.
std::string KeyOfInputs(const RecordedDrive& log, const BuildContext& context) {
  return KeyOf({kVersion, std::to_string(kStageResultsVersion), HashOf(log, context.scope),
                TrackedBy(log, context)});
}

std::string KeyOfStored(const std::string& hash) {
  return KeyOf({kVersion, std::to_string(kStageResultsVersion), hash});
}

/// \param is_whole  its bytes are known to be right: then what may never be asked for stays unread
OdometryResult ReadOdometryOf(const RecordedDrive& log, const fs::path& file,
                              bool is_whole = false) {
  OdometryResult odometry =
      is_whole ? ReadOdometryAlone(file, log.rig()) : ReadOdometry(file, log.rig());
  const TimeSpan stored = odometry.odom_from_body.span(), recorded = log.span();
  Require(recorded.Contains(stored.begin) && recorded.Contains(stored.end),
          ErrorCode::kInvalidInput, "it is of another log");
  return odometry;
}

std::optional<TakenOdometry> TakeFromMap(const RecordedDrive& log, const BuildContext& context) {
  const fs::path file = context.scope.from / log.name() / kOdometryFile;
  if (!context.from || !fs::exists(file)) return std::nullopt;
  const std::string hash = HashOf(log, context.scope);
  Require(hash.empty() || context.from->MayBeOf(log.name(), hash), ErrorCode::kInvalidInput,
          "it is of another log");
  Require(context.from->OdometryFingerprint(log.name()) == TrackedBy(log, context),
          ErrorCode::kInvalidInput, "it was tracked with other options or from other streams");
  std::string stored = Sha256OfFile(file);
  const bool is_whole =
      !context.scope.products.empty() &&
      context.cache.MapHas(log.name() + kAgreementFile, KeyOfAgreement(KeyOfStored(stored)));
  return TakenOdometry{ReadOdometryOf(log, file, is_whole), file, std::move(stored), true};
}

std::optional<TakenOdometry> TakeFromWork(const RecordedDrive& log, const BuildContext& context) {
  if (context.scope.work.empty()) return std::nullopt;
  const fs::path folder = context.scope.work / log.name();
  if (!fs::exists(folder / kInputsFile)) return std::nullopt;
  if (ReadFile(folder / kInputsFile, kMaxKeyBytes) != KeyOfInputs(log, context))
    return std::nullopt;
  const fs::path file = folder / kOdometryFile;
  return TakenOdometry{ReadOdometryOf(log, file), file, Sha256OfFile(file), false};
}

}  // namespace

std::optional<TakenOdometry> TakeOdometry(const RecordedDrive& log, const BuildContext& context) {
  for (const auto take : {TakeFromMap, TakeFromWork}) {
    try {
      if (std::optional<TakenOdometry> taken = take(log, context)) return taken;
    } catch (const Error& error) {
      LogWarning("stored odometry of drive '" + log.name() + "' cannot be used: " + error.what());
    }
  }
  return std::nullopt;
}

std::string ShareOdometry(const TakenOdometry& taken, const RecordedDrive& log,
                          const BuildContext& context) {
  const fs::path& products = context.scope.products;
  if (products.empty()) return KeyOfStored("");
  LinkOrCopy(taken.file, products / log.name() / kOdometryFile);
  return KeyOfStored(taken.hash);
}

std::string StoreOdometry(const OdometryResult& odometry, const RecordedDrive& log,
                          const BuildContext& context) {
  const BuildScope& scope = context.scope;
  if (scope.products.empty()) return KeyOfStored("");
  const fs::path name = fs::path(log.name()) / kOdometryFile;
  fs::create_directories(scope.products / log.name());
  WriteOdometry(odometry, log.rig(), scope.products / name);
  if (!scope.work.empty()) {
    context.cache.Share(name);
    WriteFileAtomically(scope.work / log.name() / kInputsFile, KeyOfInputs(log, context));
  }
  return KeyOfStored(Sha256OfFile(scope.products / name));
}

std::string KeyOfAgreement(const std::string& key_of_odometry) {
  return KeyOf({key_of_odometry, "agreement"});
}

void LoadMeasurements(const BuildScope& scope, const DriveLog& log, OdometryResult& odometry) {
  if (!odometry.measurements)
    odometry.measurements =
        ReadOdometry(scope.products / log.name() / kOdometryFile, log.rig()).measurements;
}

}  // namespace parkade
