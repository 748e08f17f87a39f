#include "server/http/route_class.h"

#include <gtest/gtest.h>

namespace parkade {
namespace {

TEST(RouteClass, IsSaidByOneTable) {
  struct Case {
    const char *method, *path;
    RouteClass expected;
  };
  for (const Case& c :
       {Case{"GET", "/healthz", RouteClass::kHealth}, Case{"GET", "/metrics", RouteClass::kHealth},
        Case{"PUT", "/api/v1/drives", RouteClass::kUploads},
        Case{"GET", "/api/v1/drives", RouteClass::kApi},
        Case{"GET", "/api/v1/drives/0123", RouteClass::kApi},
        Case{"PATCH", "/api/v1/uploads/0123", RouteClass::kUploads},
        Case{"HEAD", "/api/v1/uploads/0123", RouteClass::kUploads},
        Case{"GET", "/api/v1/uploads/0123", RouteClass::kApi},
        Case{"POST", "/api/v1/uploads", RouteClass::kUploads},
        Case{"PUT", "/api/v1/rigs/car", RouteClass::kUploads},
        Case{"GET", "/api/v1/jobs/0123/log", RouteClass::kDownloads},
        Case{"GET", "/api/v1/sites/lot/maps/1", RouteClass::kApi},
        Case{"GET", "/api/v1/sites/lot/maps/1/a/b.tum", RouteClass::kDownloads},
        Case{"GET", "/api/v1/events", RouteClass::kEvents},
        Case{"GET", "/api", RouteClass::kDownloads}, Case{"GET", "/", RouteClass::kDownloads},
        Case{"GET", "/assets/index.js", RouteClass::kDownloads},
        Case{"GET", "/api/v1/jobs//log", RouteClass::kApi}})
    EXPECT_EQ(ClassOf(c.method, c.path), c.expected) << c.method << " " << c.path;

  EXPECT_TRUE(HasLargeBody("PUT", "/api/v1/drives"));
  EXPECT_TRUE(HasLargeBody("PATCH", "/api/v1/uploads/0123"));
  EXPECT_TRUE(HasLargeBody("POST", "/api/v1/uploads"));
  EXPECT_FALSE(HasLargeBody("PATCH", "/api/v1/uploads"));
  EXPECT_FALSE(HasLargeBody("PUT", "/api/v1/rigs/car"));
}

}  // namespace
}  // namespace parkade
