#pragma once

#include <httplib.h>

#include <nlohmann/json.hpp>
#include <string>

#include "server/http/route_table.h"

namespace parkade {

/// The description of a route; null where it is of addresses that lead nowhere.
const nlohmann::json* OperationOf(const Route& route);

/// Fails the test unless openapi.json describes the answer: its status, its header fields, its
/// type and, where it is JSON, all of it.
void ExpectDescribed(const httplib::Request& request, const httplib::Response& response);

/// A client that takes no answer which is not described.
class DescribedClient : public httplib::Client {
 public:
  DescribedClient(const std::string& host, int port) : Client(host, port) {
    set_logger(ExpectDescribed);
  }
};

}  // namespace parkade
