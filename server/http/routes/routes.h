#pragma once

#include "server/http/routes/route_context.h"

namespace httplib {
class Server;
}

namespace parkade {

// One function per noun. Each adds the routes of its file to `http`; `context`
// outlives it. What exists is described in openapi.json.

void AddDriveRoutes(httplib::Server& http, RouteContext& context);
void AddUploadRoute(httplib::Server& http, RouteContext& context);
void AddTusRoutes(httplib::Server& http, RouteContext& context);
void AddRigRoutes(httplib::Server& http, RouteContext& context);
void AddJobRoutes(httplib::Server& http, RouteContext& context);
void AddSiteRoutes(httplib::Server& http, RouteContext& context);
void AddMapRoutes(httplib::Server& http, RouteContext& context);
void AddCompareRoute(httplib::Server& http, RouteContext& context);
void AddEventRoute(httplib::Server& http, RouteContext& context);
void AddStatusRoutes(httplib::Server& http, RouteContext& context);

}  // namespace parkade
