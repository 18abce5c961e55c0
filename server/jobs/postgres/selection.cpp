#include "server/jobs/postgres/selection.hpp"

namespace signorini::server::postgres {

Selection selection(const std::string& columns, const ListQuery& query, const std::string& oldest,
                    std::optional<std::size_t> limit) {
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
  sql += " WHERE whole IS NULL" + owner;
  const std::string id = query.tag ? "job" : "id";
  if (!oldest.empty()) sql += " AND " + id + " >= " + place(oldest);
  if (query.after) sql += " AND " + id + " < " + place(*query.after);
  if (query.status) sql += " AND status = " + place(name(*query.status));
  if (query.title)
    sql += " AND position(" + place(Bytes{*query.title}) +
           R"( IN convert_to(lower(title COLLATE "C"), 'UTF8')) > 0)";
  sql += " ORDER BY " + id + " DESC";
  if (limit) sql += " LIMIT " + place(*limit);
  return {std::move(sql), std::move(values)};
}

Selection oldest_read(const ListQuery& query) {
  Values values;
  values.add(titles_of_a_page - 1);
  if (query.after) values.add(*query.after);
  return {std::string("SELECT id FROM jobs") + (query.after ? " WHERE id < $2" : "") +
              " ORDER BY id DESC LIMIT 1 OFFSET $1",
          std::move(values)};
}

}  // namespace signorini::server::postgres
