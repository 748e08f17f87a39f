#include "server/store/tables/review_table.h"

namespace parkade {

void AddReviewEntry(Connection& connection, const std::string& map, const ReviewEntry& entry) {
  connection.Execute(
      "INSERT INTO reviews (map, action, from_state, to_state, comment, author, created_at) VALUES "
      "(?, ?, ?, ?, ?, ?, ?)",
      map, entry.action, std::string(ToText(entry.from)), std::string(ToText(entry.to)),
      entry.comment, entry.author, entry.created_at);
  connection.Execute("UPDATE maps SET review_state = ? WHERE id = ?", std::string(ToText(entry.to)),
                     map);
}

std::vector<ReviewEntry> ListReviewEntries(Connection& connection, const std::string& map,
                                           const Page& page) {
  Statement query = connection.Query(
      R"(SELECT sequence, action, from_state, to_state, comment, author, created_at FROM reviews
         WHERE map = ? AND sequence < ? ORDER BY sequence DESC LIMIT ?)",
      map, page.before, page.limit);
  std::vector<ReviewEntry> entries;
  while (query.Step())
    entries.push_back({query.Integer(0), query.Text(1), ReviewStateFromText(query.Text(2)),
                       ReviewStateFromText(query.Text(3)), query.Text(4), query.Text(5),
                       query.Text(6)});
  return entries;
}

std::int64_t CountReviewEntries(Connection& connection, const std::string& map) {
  Statement query = connection.Query("SELECT count(*) FROM reviews WHERE map = ?", map);
  query.Step();
  return query.Integer(0);
}

}  // namespace parkade
