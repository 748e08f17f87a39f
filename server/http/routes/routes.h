#pragma once

#include "server/http/access/router.h"
#include "server/http/routes/route_context.h"

namespace parkade {

// One function per noun. Each adds the handlers of its file to `routes`; `context` outlives them.
// What exists is said by kRoutes and described in openapi.json.

void AddDriveRoutes(Router& routes, RouteContext& context);
void AddPictureRoutes(Router& routes, RouteContext& context);
void AddPlotRoutes(Router& routes, RouteContext& context);
void AddUploadRoute(Router& routes, RouteContext& context);
void AddTusRoutes(Router& routes, RouteContext& context);
void AddUploadSetRoutes(Router& routes, RouteContext& context);
void AddRigRoutes(Router& routes, RouteContext& context);
void AddJobRoutes(Router& routes, RouteContext& context);
void AddSiteRoutes(Router& routes, RouteContext& context);
// Before the map routes, whose files would take their addresses.
void AddReviewRoutes(Router& routes, RouteContext& context);
void AddCommentRoutes(Router& routes, RouteContext& context);
void AddMapRoutes(Router& routes, RouteContext& context);
void AddOverviewRoutes(Router& routes, RouteContext& context);
void AddMeasurementRoutes(Router& routes, RouteContext& context);
void AddWebhookRoutes(Router& routes, RouteContext& context);
void AddCompareRoute(Router& routes, RouteContext& context);
void AddEventRoute(Router& routes, RouteContext& context);
void AddSessionRoutes(Router& routes, RouteContext& context);
void AddTokenRoutes(Router& routes, RouteContext& context);
void AddShareRoutes(Router& routes, RouteContext& context);
void AddAuditRoute(Router& routes, RouteContext& context);
void AddStatusRoutes(Router& routes, RouteContext& context);

}  // namespace parkade
