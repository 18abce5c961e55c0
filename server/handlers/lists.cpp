#include "server/handlers/lists.hpp"

#include <algorithm>
#include <cstdlib>

#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"
#include "server/handlers/dismiss.hpp"
#include "server/handlers/document_response.hpp"
#include "server/handlers/documents.hpp"
#include "server/http/conditions.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

/// Bytes of a character in UTF-8, at most.
constexpr std::size_t longest_title = 4 * api::limits::title;

JobStatus status_of_name(const std::string& status_name) {
  if (const std::optional<JobStatus> status = job_status(status_name)) return *status;
  throw bad_parameter("status",
                      "`status` must be one of `queued`, `running`, `succeeded`, `failed`, `cancelled`.");
}

std::optional<std::string> tag_of(const Request& request) {
  std::optional<std::string> tag = parameter(request.query, "tag");
  if (!tag) return tag;
  if (const auto fault = api::fault_of_tag(*tag)) throw bad_parameter("tag", "`tag` " + *fault + ".");
  return tag;
}

/// All solves that the client may see.
ListQuery what_may_be_seen(const Request& request) {
  ListQuery query;
  if (!request.identity.sees_all()) query.owner = request.identity.name;
  return query;
}

ListQuery list_query(const Request& request) {
  allow_only(request.query, {"status", "tag", "title", "limit", "after"});
  ListQuery query = what_may_be_seen(request);
  if (const auto status = parameter(request.query, "status")) query.status = status_of_name(*status);
  query.tag = tag_of(request);
  query.title = parameter(request.query, "title");
  if (query.title && (query.title->empty() || query.title->size() > longest_title))
    throw bad_parameter(
        "title", "`title` must be a part of a title: 1 to " + std::to_string(longest_title) + " bytes.");
  if (const auto limit = integer_parameter(request.query, "limit", 1, 1000)) {
    query.limit = static_cast<std::size_t>(*limit);
  }
  query.after = parameter(request.query, "after");
  if (query.after && !is_unique_id(*query.after)) {
    throw bad_parameter("after", "`after` must be the id of a solve, as `links.next` of a page has it.");
  }
  return query;
}

/// 409: nothing was done yet.
HttpError not_confirmed(const std::string& tag, std::size_t count) {
  const std::string number = std::to_string(count);
  return {409,
          {"confirmation-needed",
           "A confirmation is needed",
           number + (count == 1 ? " solve has" : " solves have") + " the tag `" + tag +
               "`, and nothing was done. With `&confirm=" + number +
               "` those that have not ended are cancelled, and the others deleted.",
           {},
           count}};
}

}  // namespace

Response list_solves(Service& service, const Request& request) {
  const ListQuery query = list_query(request);
  const JobPage page = service.store.list(query);
  return document_response(
      request, 200, [lives = service.scheduler.live(page.jobs), page, query](api::DocumentWriter& out) {
        write_list(out, page, query, lives);
      });
}

Length length_of_list(const Query& query) {
  const std::string limit = parameter(query, "limit").value_or("0");
  const bool has_many = std::strtol(limit.c_str(), nullptr, 10) > static_cast<long>(ListQuery().limit);
  return has_many ? Length::list : Length::brief;
}

Response delete_tagged(Service& service, const Request& request) {
  allow_only(request.query, {"tag", "confirm"});
  ListQuery query = what_may_be_seen(request);
  query.tag = tag_of(request);
  if (!query.tag) throw bad_parameter("tag", "`tag` must say which solves: DELETE /v1/solves?tag=NAME.");
  constexpr long any_number = std::numeric_limits<int>::max();
  const auto confirmed = integer_parameter(request.query, "confirm", 0, any_number);
  const std::vector<std::string> ids = service.store.ids(query);
  const auto count = static_cast<long>(ids.size());
  require_conditions(request);
  if (confirmed != count) throw not_confirmed(*query.tag, ids.size());
  return dismissed_response(request, dismiss(service, ids));
}

}  // namespace signorini::server
