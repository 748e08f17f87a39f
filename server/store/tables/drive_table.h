#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/tables/database.h"
#include "server/store/tables/records.h"
#include "server/store/tables/site_scope.h"

namespace parkade {

// Rows of `drives`. A deleted drive stays as a tombstone, so that jobs and maps
// can still name it, and is in no answer here but FindDriveOrTombstone.

void InsertDrive(Connection& connection, const Drive& drive);

/// Throws Error{kNotFound}.
Drive FindDrive(Connection& connection, const std::string& id);
Drive FindDriveOrTombstone(Connection& connection, const std::string& id);

bool HasLog(Connection& connection, const std::string& id);

/// The oldest drive that waits for a first look at its log.
std::optional<Drive> NextDriveToInspect(Connection& connection);
void SetDriveInspection(Connection& connection, const std::string& id,
                        const DriveInspection& inspection);
/// What the look found, JSON.
std::optional<std::string> InspectionOf(Connection& connection, const std::string& id);

/// Newest first; only those of sites in `scope`, and of `site` where given.
std::vector<Drive> ListDrives(Connection& connection, const Page& page,
                              const std::optional<std::string>& site, const SiteScope& scope = {});

/// All ids of a site's drives whose logs are stored, in order of arrival.
std::vector<std::string> DrivesOfSite(Connection& connection, const std::string& site);
/// `new_drive`, unless it was deleted, and the drives that it is joined with: those `beside` it,
/// and those of its site that are in a map and have their logs, since other drives that wait have
/// jobs that join them later. Where logs are equal, a new drive's is taken, or else the one that
/// came last. In order of arrival; empty where the new drive was deleted.
std::vector<std::string> DrivesToJoin(Connection& connection, const std::string& new_drive,
                                      const std::vector<std::string>& beside = {});

/// `wanted`, or `wanted-2`, ... where the site had a drive of that name: a drive's
/// name is its folder in the site's maps.
std::string FreeDriveName(Connection& connection, const std::string& site,
                          const std::string& wanted);

void SetDriveState(Connection& connection, const std::string& id, DriveState state,
                   const std::optional<std::string>& error);
void SetDriveStreams(Connection& connection, const std::string& id,
                     const std::string& streams_json);
void MarkDriveDeleted(Connection& connection, const std::string& id);

/// The drive stays without its log.
void MarkLogDeleted(Connection& connection, const std::string& id, const std::string& now);

/// Throws Error{kConflict} saying so where the drive's log was deleted.
void RequireLog(const Drive& drive);

/// Drives (not deleted) whose log is stored and has this content.
std::int64_t CountDrivesWithContent(Connection& connection, const std::string& sha256);

/// True when a published map was made from this drive.
bool HasMap(Connection& connection, const std::string& drive_id);

}  // namespace parkade
