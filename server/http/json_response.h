#pragma once

#include <httplib.h>

#include <optional>
#include <string>
#include <vector>

#include "server/http/json_view.h"

namespace parkade {

void SendJson(httplib::Response& response, int status, const Json& json);

/// A query parameter; nothing where absent or empty.
std::optional<std::string> QueryParameter(const httplib::Request& request, const char* name);

/// `limit` (1 to 200, default 50) and `cursor` of a list. Throws
/// Error{kInvalidInput} for others.
Page PageOf(const httplib::Request& request);

/// Sends {"items": [...], "next_cursor": "..." or null}. `rows` were asked for
/// with one more than `page.limit`, to see whether anything follows.
template <typename Row, typename Convert>
void SendPage(httplib::Response& response, const Page& page, std::vector<Row> rows,
              const Convert& convert) {
  const bool has_more = rows.size() > static_cast<size_t>(page.limit);
  if (has_more) rows.resize(static_cast<size_t>(page.limit));
  Json json = {{"items", Json::array()}};
  for (const Row& row : rows) json["items"].push_back(convert(row));
  json["next_cursor"] = has_more ? Json(std::to_string(rows.back().sequence)) : Json(nullptr);
  SendJson(response, 200, json);
}

/// `page` with room for the row that tells whether anything follows.
inline Page WithOneMore(Page page) {
  ++page.limit;
  return page;
}

/// Reads a small body whole. Throws Error{kInvalidInput} above `max_bytes`, without reading on, and
/// when the client breaks off.
std::string ReadBody(const httplib::ContentReader& body, size_t max_bytes);

}  // namespace parkade
