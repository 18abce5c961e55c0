#include "server/handlers/problems.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "api/examples.hpp"
#include "api/result/result_document.hpp"
#include "server/gallery/example_pictures.hpp"
#include "server/handlers/document_response.hpp"
#include "server/handlers/downloads.hpp"
#include "server/handlers/intake.hpp"
#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"
#include "solve.hpp"

namespace signorini::server {
namespace {

/// More than any picture of an example takes.
constexpr std::size_t longest_picture = 4'000'000;

/// The example of the path. Throws HttpError 404.
const api::Example& find_example(const Request& request) {
  const std::string& wanted = request.path_parameters.at("name");
  const auto found = std::ranges::find(api::examples(), wanted, &api::Example::name);
  if (found != api::examples().end()) return *found;
  throw HttpError(404, {"unknown-example", "Unknown example",
                        "There is no example of this name; GET /v1/examples lists them."});
}

}  // namespace

Response validate_problem(Service& service, const Request& request) {
  allow_only(request.query, {});
  const Intake intake = take_in(service, request);
  const std::vector<std::string> left = look_ahead(intake.request.problem, intake.request.sweep);
  return document_response(request, 200, [foreseen = intake.foreseen, left](api::DocumentWriter& out) {
    api::write_estimates(out, foreseen, left);
  });
}

Response list_examples(Service&, const Request& request) {
  allow_only(request.query, {});
  return document_response(request, 200, [](api::DocumentWriter& out) {
    out.begin_object().key("examples").begin_array();
    for (const api::Example& example : api::examples()) {
      const std::string title = nlohmann::json::parse(example.json).value("title", "");
      out.begin_object().member("name", example.name).member("title", title).key("links");
      out.begin_object()
          .member("self", "/v1/examples/" + std::string(example.name))
          .end_object()
          .end_object();
    }
    out.end_array().end_object();
  });
}

Response get_example(Service&, const Request& request) {
  allow_only(request.query, {});
  const api::Example& example = find_example(request);
  return document_response(request, 200, [&example](api::DocumentWriter& out) { out.json(example.json); });
}

Response get_example_picture(Service&, const Request& request) {
  allow_only(request.query, {});
  const std::string file = std::string(find_example(request).name) + ".svg.gz";
  Response response = Response::empty(200);
  response.content_type = svg_media_type;
  response.compressed = &std::ranges::find(example_pictures(), file, &ExamplePicture::name)->compressed;
  if (!request.accepts_gzip) response.body = decoded(*response.compressed, {"gzip"}, longest_picture);
  return response;
}

}  // namespace signorini::server
