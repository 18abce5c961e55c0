#include "server/jobs/postgres/selection.hpp"

namespace signorini::server::postgres {

Selection selection(const std::string& columns, const ListQuery& query, std::optional<std::size_t> limit) {
  Values values;
  const auto place = [&](const auto& value) {
    values.add(value);
    return "$" + std::to_string(values.size());
  };
  std::string sql = "SELECT " + columns + " FROM jobs";
  const std::string owner = query.owner ? " AND owner = " + place(*query.owner) : "";
  // Tags and titles as bytes, for what a client asks for need not be a text.
  if (query.tag)
    sql += " JOIN (SELECT job FROM job_tags WHERE tag = " + place(Bytes{*query.tag}) + owner +
           ") AS tagged ON job = id";
  sql += " WHERE true" + owner;
  if (query.after) sql += std::string(query.tag ? " AND job < " : " AND id < ") + place(*query.after);
  if (query.status) sql += " AND status = " + place(name(*query.status));
  if (query.title)
    sql += " AND position(" + place(Bytes{*query.title}) +
           R"( IN convert_to(lower(title COLLATE "C"), 'UTF8')) > 0)";
  sql += query.tag ? " ORDER BY job DESC" : " ORDER BY id DESC";
  if (limit) sql += " LIMIT " + place(*limit);
  return {std::move(sql), std::move(values)};
}

}  // namespace signorini::server::postgres
