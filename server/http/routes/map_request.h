#pragma once

#include <httplib.h>

#include <string>
#include <vector>

#include "server/store/job_queue.h"

namespace parkade {

/// What the body of a request to build a map asks for.
struct MapRequest {
  std::vector<std::string> drives;  ///< ids; empty: those of the site
  MapReview review;
};

/// Reads {"drives": [ID, ...], "from": VERSION, "reject_loops": [LOOP, ...], "force_loops": [LOOP,
/// ...], "reject_links": [LINK, ...], "force_links": [LINK, ...], "pins": [{"point": [X, Y, Z],
/// "latitude": LAT, "longitude": LON, "height": HEIGHT, "drive": NAME}, ...]}, all of them
/// optional. Throws Error{kInvalidInput}.
MapRequest ReadMapRequest(const httplib::ContentReader& body);

}  // namespace parkade
