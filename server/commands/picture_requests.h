#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "server/ingest/pictures/picture_index.h"
#include "server/map_folder/point_views.h"

namespace parkade {

/// Answers what a service asks about the pictures of one log, which stays open in between.
class PictureRequests {
 public:
  /// Opens the log, and makes its index in the file `index` unless it is there. Throws Error as
  /// OpenTranslatedLog and IndexPictures do.
  PictureRequests(const std::filesystem::path& log, const std::filesystem::path& rig_folder,
                  const std::filesystem::path& index);

  /// One request, as server/jobs/pictures/picture_worker.h has them, and its answer. Throws Error.
  nlohmann::json Answer(const nlohmann::json& request);

 private:
  nlohmann::json WritePicture(const nlohmann::json& request) const;
  nlohmann::json FindViews(const nlohmann::json& request);
  DriveViews ReadViews(const std::filesystem::path& map, const std::string& drive) const;

  std::filesystem::path rig_folder_;
  std::shared_ptr<const MessageSource> source_;
  PictureIndex index_;
  std::string views_of_;  ///< map and drive that `views_` are of
  std::optional<DriveViews> views_;
};

}  // namespace parkade
