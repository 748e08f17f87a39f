#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "server/store/store.h"
#include "server/store/tables/records.h"

namespace parkade {

/// Files of a rig by name: camchain-imucam.yaml, imu0.yaml, vehicle.yaml, and
/// the mask images they name.
using RigFiles = std::map<std::string, std::string>;

/// All files of a rig together [bytes] are texts of a few KiB, and what goes with them.
constexpr size_t kMaxRigBytes = size_t{4} << 20;

/// Unpacks a zip of rig files; a folder around them is dropped. Nothing is
/// written to disk. Throws Error{kInvalidInput} when it is not a zip, holds
/// anything else than plain files with plain names, or unpacks to more than
/// kMaxRigBytes or 64 files.
RigFiles UnpackRig(const std::string& zip);

/// Packs the files as a zip, byte for byte the same each time.
std::string PackRig(const RigFiles& files);

/// Checks and stores a revision of the rig `name`. Files that are called as Kalibr calls them
/// (FindRigFiles) get their usual names. `check_rig` is given a folder with the files and throws
/// when they are not a rig. Throws Error{kInvalidInput} when one of the three files is missing.
StoredRig StoreRig(Store& store, const std::string& name, RigFiles files,
                   const std::function<void(const std::filesystem::path&)>& check_rig);

/// The zip of a stored rig.
std::string ReadRigArchive(const Store& store, const StoredRig& rig);

}  // namespace parkade
