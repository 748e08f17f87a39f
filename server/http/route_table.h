#pragma once

#include <array>
#include <set>
#include <stdexcept>
#include <string_view>

#include "server/http/route_class.h"

namespace parkade {

/// What a caller needs to be allowed, from the least to the most.
enum class Right {
  kNone,       ///< nothing: anybody may
  kSeeMaps,    ///< to see maps: every role, and who has a link to the site
  kSee,        ///< to see all but camera pictures: every role
  kUpload,     ///< to bring something in: uploaders
  kOwnUpload,  ///< the same, for what the caller brought in itself; admins for all
  kRunJob,     ///< to cancel and repeat jobs: reviewers, and uploaders for their own drives' jobs
  kReview,     ///< to judge maps: reviewers
  kPictures,   ///< to see camera pictures: who was given that by name, whatever the role
  kAdmin,      ///< admins
};

/// The sites that a route tells of, for callers that may see some sites only.
enum class Reach {
  kPath,      ///< of the one in the path, or whose drive, job, upload or link is in the path
  kFiltered,  ///< of many: the handler leaves out what the caller may not see
  kWhole,     ///< of the whole service: callers of some sites may not
  kNothing,   ///< of none
};

/// One method of one address.
struct Route {
  constexpr Route(std::string_view its_method, std::string_view its_path, RouteClass its_class,
                  Right its_right, Reach its_reach, bool its_body_is_large = false)
      : method(its_method),
        path(its_path),
        route_class(its_class),
        right(its_right),
        reach(its_reach),
        has_large_body(its_body_is_large) {}

  std::string_view method;  ///< empty: any
  /// "{NAME}" stands for a segment, "{file}" and "{any}" at the end for one or more.
  std::string_view path;
  RouteClass route_class;
  Right right;
  Reach reach;
  bool has_large_body;  ///< may be as large as a drive log
};

/// All that the service answers; the first row that fits counts. Handlers are added by naming a
/// row (RouteName), so that no route is without a right.
inline constexpr std::array kRoutes = {
    Route{"GET", "/healthz", RouteClass::kHealth, Right::kNone, Reach::kNothing},
    Route{"GET", "/readyz", RouteClass::kHealth, Right::kNone, Reach::kNothing},
    Route{"GET", "/metrics", RouteClass::kHealth, Right::kSee, Reach::kWhole},
    Route{"GET", "/api/v1/openapi.json", RouteClass::kApi, Right::kNone, Reach::kNothing},

    Route{"PUT", "/api/v1/drives", RouteClass::kUploads, Right::kUpload, Reach::kFiltered, true},
    Route{"POST", "/api/v1/uploads", RouteClass::kUploads, Right::kUpload, Reach::kFiltered, true},
    Route{"OPTIONS", "/api/v1/uploads", RouteClass::kApi, Right::kNone, Reach::kNothing},
    Route{"OPTIONS", "/api/v1/uploads/{upload}", RouteClass::kApi, Right::kNone, Reach::kNothing},
    Route{"GET", "/api/v1/uploads/{upload}", RouteClass::kApi, Right::kOwnUpload, Reach::kPath},
    // HEAD and DELETE wait until a part under way has stopped.
    Route{"HEAD", "/api/v1/uploads/{upload}", RouteClass::kUploads, Right::kOwnUpload,
          Reach::kPath},
    Route{"DELETE", "/api/v1/uploads/{upload}", RouteClass::kUploads, Right::kOwnUpload,
          Reach::kPath},
    Route{"PATCH", "/api/v1/uploads/{upload}", RouteClass::kUploads, Right::kOwnUpload,
          Reach::kPath, true},
    Route{"POST", "/api/v1/uploads/{upload}", RouteClass::kUploads, Right::kOwnUpload, Reach::kPath,
          true},
    Route{"POST", "/api/v1/upload-sets", RouteClass::kUploads, Right::kUpload, Reach::kFiltered},
    Route{"GET", "/api/v1/upload-sets/{set}", RouteClass::kApi, Right::kOwnUpload, Reach::kPath},
    Route{"DELETE", "/api/v1/upload-sets/{set}", RouteClass::kUploads, Right::kOwnUpload,
          Reach::kPath},

    Route{"GET", "/api/v1/drives", RouteClass::kApi, Right::kSee, Reach::kFiltered},
    Route{"GET", "/api/v1/drives/{drive}", RouteClass::kApi, Right::kSee, Reach::kPath},
    Route{"GET", "/api/v1/drives/{drive}/inspect", RouteClass::kApi, Right::kSee, Reach::kPath},
    Route{"GET", "/api/v1/drives/{drive}/keyframes", RouteClass::kApi, Right::kSee, Reach::kPath},
    Route{"GET", "/api/v1/drives/{drive}/plots", RouteClass::kApi, Right::kSee, Reach::kPath},
    // They wait for a process.
    Route{"GET", "/api/v1/drives/{drive}/images", RouteClass::kDownloads, Right::kPictures,
          Reach::kPath},
    Route{"GET", "/api/v1/drives/{drive}/images/{camera}", RouteClass::kDownloads, Right::kPictures,
          Reach::kPath},
    Route{"DELETE", "/api/v1/drives/{drive}", RouteClass::kApi, Right::kOwnUpload, Reach::kPath},

    // A rig of one name serves all sites.
    Route{"GET", "/api/v1/rigs", RouteClass::kApi, Right::kSee, Reach::kNothing},
    Route{"GET", "/api/v1/rigs/{rig}", RouteClass::kDownloads, Right::kSee, Reach::kNothing},
    Route{"PUT", "/api/v1/rigs/{rig}", RouteClass::kUploads, Right::kUpload, Reach::kWhole},

    Route{"GET", "/api/v1/jobs", RouteClass::kApi, Right::kSee, Reach::kFiltered},
    Route{"GET", "/api/v1/jobs/{job}", RouteClass::kApi, Right::kSee, Reach::kPath},
    Route{"GET", "/api/v1/jobs/{job}/log", RouteClass::kDownloads, Right::kSee, Reach::kPath},
    Route{"GET", "/api/v1/jobs/{job}/preview.glb", RouteClass::kDownloads, Right::kSee,
          Reach::kPath},
    Route{"POST", "/api/v1/jobs/{job}/cancel", RouteClass::kApi, Right::kRunJob, Reach::kPath},
    Route{"POST", "/api/v1/jobs/{job}/retry", RouteClass::kApi, Right::kRunJob, Reach::kPath},
    Route{"GET", "/api/v1/events", RouteClass::kEvents, Right::kSee, Reach::kFiltered},

    Route{"GET", "/api/v1/sites", RouteClass::kApi, Right::kSeeMaps, Reach::kFiltered},
    Route{"GET", "/api/v1/sites/{site}", RouteClass::kApi, Right::kSeeMaps, Reach::kPath},
    Route{"PUT", "/api/v1/sites/{site}", RouteClass::kApi, Right::kAdmin, Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps", RouteClass::kApi, Right::kSeeMaps, Reach::kPath},
    Route{"POST", "/api/v1/sites/{site}/maps", RouteClass::kApi, Right::kReview, Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{version}", RouteClass::kApi, Right::kSeeMaps,
          Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{alias}", RouteClass::kApi, Right::kSeeMaps,
          Reach::kPath},
    // These go before files: none of a map is called so.
    Route{"GET", "/api/v1/sites/{site}/maps/{version}/review", RouteClass::kApi, Right::kSee,
          Reach::kPath},
    Route{"POST", "/api/v1/sites/{site}/maps/{version}/review", RouteClass::kApi, Right::kReview,
          Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{version}/checklist", RouteClass::kApi, Right::kSee,
          Reach::kPath},
    Route{"PUT", "/api/v1/sites/{site}/maps/{version}/checklist/{item}", RouteClass::kApi,
          Right::kReview, Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{version}/comments", RouteClass::kApi, Right::kSee,
          Reach::kPath},
    Route{"POST", "/api/v1/sites/{site}/maps/{version}/comments", RouteClass::kApi, Right::kReview,
          Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{version}/comments/{comment}", RouteClass::kApi,
          Right::kSee, Reach::kPath},
    Route{"PATCH", "/api/v1/sites/{site}/maps/{version}/comments/{comment}", RouteClass::kApi,
          Right::kReview, Reach::kPath},
    Route{"DELETE", "/api/v1/sites/{site}/maps/{version}/comments/{comment}", RouteClass::kApi,
          Right::kReview, Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{version}/{file}", RouteClass::kDownloads,
          Right::kSeeMaps, Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/maps/{alias}/{file}", RouteClass::kDownloads,
          Right::kSeeMaps, Reach::kPath},
    // It waits for a worker process.
    Route{"GET", "/api/v1/sites/{site}/compare", RouteClass::kDownloads, Right::kSeeMaps,
          Reach::kPath},

    // Over all sites.
    Route{"GET", "/api/v1/maps", RouteClass::kApi, Right::kSee, Reach::kFiltered},
    Route{"GET", "/api/v1/comments", RouteClass::kApi, Right::kSee, Reach::kFiltered},

    // A session is for who shows a token or a link, which the handlers ask for.
    Route{"GET", "/api/v1/session", RouteClass::kApi, Right::kNone, Reach::kNothing},
    Route{"POST", "/api/v1/session", RouteClass::kApi, Right::kNone, Reach::kNothing},
    Route{"DELETE", "/api/v1/session", RouteClass::kApi, Right::kNone, Reach::kNothing},
    Route{"GET", "/api/v1/tokens", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"POST", "/api/v1/tokens", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"DELETE", "/api/v1/tokens/{token}", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"GET", "/api/v1/shares", RouteClass::kApi, Right::kReview, Reach::kFiltered},
    Route{"POST", "/api/v1/shares", RouteClass::kApi, Right::kReview, Reach::kFiltered},
    Route{"DELETE", "/api/v1/shares/{share}", RouteClass::kApi, Right::kReview, Reach::kPath},
    Route{"GET", "/api/v1/audit", RouteClass::kApi, Right::kAdmin, Reach::kWhole},

    Route{"GET", "/api/v1/sites/{site}/measurements", RouteClass::kApi, Right::kSee, Reach::kPath},
    Route{"POST", "/api/v1/sites/{site}/measurements", RouteClass::kApi, Right::kReview,
          Reach::kPath},
    Route{"GET", "/api/v1/sites/{site}/measurements/{measurement}", RouteClass::kApi, Right::kSee,
          Reach::kPath},
    Route{"DELETE", "/api/v1/sites/{site}/measurements/{measurement}", RouteClass::kApi,
          Right::kReview, Reach::kPath},

    Route{"GET", "/api/v1/webhooks", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"POST", "/api/v1/webhooks", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"DELETE", "/api/v1/webhooks/{webhook}", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"GET", "/api/v1/webhooks/{webhook}/deliveries", RouteClass::kApi, Right::kAdmin,
          Reach::kWhole},
    Route{"POST", "/api/v1/webhooks/{webhook}/test", RouteClass::kApi, Right::kAdmin,
          Reach::kWhole},

    // Addresses that lead nowhere, and the viewer, which holds nothing of anybody's.
    Route{"", "/api/{any}", RouteClass::kApi, Right::kAdmin, Reach::kWhole},
    Route{"", "/{any}", RouteClass::kDownloads, Right::kNone, Reach::kNothing},
};

/// A row of kRoutes by its method and path as one text, "GET /api/v1/drives/{drive}". A name
/// without a row does not compile.
class RouteName {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): routes are named by texts
  consteval RouteName(const char* text) : RouteName(std::string_view(text)) {}
  constexpr const Route& route() const { return kRoutes[index_]; }

 private:
  consteval explicit RouteName(std::string_view text) {
    const std::string_view method = text.substr(0, text.find(' '));
    const std::string_view path = text.substr(method.size() + 1);
    while (kRoutes[index_].method != method || kRoutes[index_].path != path)
      if (++index_ == kRoutes.size()) throw std::invalid_argument("no such route");
  }

  size_t index_ = 0;
};

/// The row that a request's method and path (without the query) belong to. HEAD is asked of where
/// GET is, unless it has a row of its own.
const Route& RouteOf(std::string_view method, std::string_view path);

/// Methods that `path` has, in the order of the alphabet; none where it leads nowhere. Tells 405
/// from 404.
std::set<std::string_view> MethodsOf(std::string_view path);

}  // namespace parkade
