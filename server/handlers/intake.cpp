#include "server/handlers/intake.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include <malloc.h>

#include "api/document/cbor_document.hpp"
#include "server/http/content.hpp"
#include "server/http/error.hpp"
#include "server/http/media_type.hpp"
#include "server/http/message.hpp"
#include "server/jobs/run.hpp"

namespace signorini::server {
namespace {

/// CBOR is turned into the JSON text that is read, kept and answered.
std::string json_of(const std::string& cbor, std::size_t max_bytes) {
  if (std::optional<std::string> text = api::json_of_cbor(cbor, max_bytes)) return std::move(*text);
  throw HttpError(413, {"body-too-large", "Body too large",
                        "As JSON the body is longer than " + std::to_string(max_bytes) +
                            " bytes (--max-body-bytes), which is how it is counted."});
}

/// Whether the body is CBOR and not JSON.
bool is_in_cbor(const Request& request) {
  const std::optional<std::string> type = request.header("Content-Type");
  if (type && is_json(*type)) return false;
  if (type && is_cbor(*type)) return true;
  throw HttpError(
      415,
      {"unsupported-media-type", "Unsupported media type",
       std::string(type ? "The body is declared as neither JSON nor CBOR."
                        : "The request has no Content-Type.") +
           " Send it as application/json or application/cbor: curl -H 'Content-Type: application/json'."});
}

/// Ends the reading of a problem whose client has left.
class WhileClientWaits : public Observer {
 public:
  explicit WhileClientWaits(const Request& request) : request_(request) {}

  bool keep_going() override { return !request_.client_left(); }

  /// Throws Cancelled.
  void check() {
    if (!keep_going()) throw Cancelled();
  }

 private:
  const Request& request_;
};

/// 413 for a problem that would be too large here: what in it is, and how to make it smaller.
HttpError too_large(const std::string& kind, const std::string& what, const std::string& pointer,
                    const std::string& detail) {
  return {413, {kind, what + " is too large", detail, {{"pointer", pointer, detail}}}};
}

void require_few_unknowns(const Intake& intake, const Limits& limits) {
  const std::int64_t unknowns = intake.foreseen.problem.unknowns.stress;
  if (unknowns <= limits.max_unknowns) return;
  const bool grows = intake.request.problem.mesh.adaptive.has_value();
  throw too_large("too-many-unknowns", "The problem", grows ? "/mesh/adaptive/max_triangles" : "/mesh",
                  (grows ? "It may grow to " : "It has ") + std::to_string(unknowns) +
                      " stress unknowns; this service takes up to " + std::to_string(limits.max_unknowns) +
                      " (--max-unknowns). " +
                      (grows ? "Lower mesh.adaptive.max_triangles." : "Take a coarser mesh."));
}

std::string gigabytes(double bytes) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g GB", bytes / 1e9);
  return text.data();
}

void require_little_memory(const Intake& intake, const Limits& limits, const Identity& identity) {
  const double bytes = intake.memory(), share = identity.share.memory.value_or(limits.max_memory);
  if (bytes <= std::min(limits.max_memory, share)) return;
  const std::string given =
      share < limits.max_memory
          ? gigabytes(share) + " to the solves of `" + identity.name + "` (memory= in the token file)"
          : "a solve up to " + gigabytes(limits.max_memory) + " (--max-memory)";
  throw too_large(
      "too-much-memory", "The problem", "/mesh",
      "It would take about " + gigabytes(bytes) + " of memory; this service gives " + given +
          ". Take a coarser mesh" +
          (intake.request.problem.scheme == Scheme::conforming ? " or the nonconforming scheme." : "."));
}

/// What a sweep holds are the contact unknowns of its entries; and each material is as much work as a
/// problem.
void require_short_sweep(const Intake& intake, const Limits& limits) {
  const Unknowns& unknowns = intake.foreseen.problem.unknowns;
  const auto entries = static_cast<std::int64_t>(intake.request.sweep.size());
  const auto operators = static_cast<std::int64_t>(1 + operators_of(intake.request.sweep));
  const std::int64_t of_contact = entries * unknowns.contact, of_stress = operators * unknowns.stress;
  if (std::max(of_contact, operators > 1 ? of_stress : 0) <= limits.max_unknowns) return;
  const bool by_materials = of_contact <= limits.max_unknowns;
  throw too_large("too-many-unknowns", "The sweep", "/sweep",
                  (by_materials ? "By its " + std::to_string(operators) + " materials it has " +
                                      std::to_string(of_stress) + " stress unknowns"
                                : "Its " + std::to_string(entries) + " entries have " +
                                      std::to_string(of_contact) + " contact unknowns") +
                      " together; this service takes up to " + std::to_string(limits.max_unknowns) +
                      " (--max-unknowns). Split the sweep" +
                      (by_materials ? "." : ": the later parts find the factor of the first."));
}

/// The runs follow each other, but their times add up.
void require_short_study(const Intake& intake, const Limits& limits) {
  std::int64_t unknowns = 0;
  for (const Estimate& run : intake.foreseen.runs) unknowns += run.unknowns.stress;
  if (unknowns <= limits.max_unknowns) return;
  const Study& study = *intake.request.study;
  throw too_large(
      "too-many-unknowns", "The study", "/study",
      "Its " + std::to_string(study.schemes.size() * study.meshes.size()) + " runs have more than " +
          std::to_string(limits.max_unknowns) +
          " stress unknowns together, which is what this service takes (--max-unknowns). Leave the "
          "finest meshes out, or lower study.adaptive.max_triangles.");
}

}  // namespace

void require_readable(const Request& request) {
  is_in_cbor(request);
  require_known(list_of(request.headers, "Content-Encoding"));
}

std::string json_body(const Request& request, std::size_t max_bytes) {
  const bool is_cbor = is_in_cbor(request);
  std::string text = request.read_body(max_bytes);
  return is_cbor ? json_of(text, max_bytes) : text;
}

Intake judge(std::string text, const Request& request, const Limits& limits) {
  WhileClientWaits observer(request);
  Intake intake;
  intake.text = std::move(text);
  intake.request = api::parse_request(intake.text, &observer);
  intake.request.settings.factorization = limits.factorization;
  intake.request.settings.threads = limits.threads;
  observer.check();
  intake.foreseen = estimate(intake.request.problem, intake.request.sweep, intake.request.study,
                             intake.request.settings, limits.max_unknowns);
  require_few_unknowns(intake, limits);
  require_short_sweep(intake, limits);
  require_short_study(intake, limits);
  require_little_memory(intake, limits, request.identity);
  return intake;
}

HttpError client_left() {
  return {400, {"client-left", "The client left", "The client left before its problem was read."}};
}

ReleasedMemory::~ReleasedMemory() {
  if (is_much_) malloc_trim(0);
}

double Intake::memory() const {
  return foreseen.memory_bytes();
}

Intake take_in(Service& service, const Request& request) {
  std::string text = json_body(request, service.limits.max_body_bytes);
  const ReleasedMemory released(text.size());
  try {
    return judge(std::move(text), request, service.limits);
  } catch (const Cancelled&) {
    throw client_left();
  }
}

Intake take_in_study(Service& service, const Request& request) {
  Intake intake = take_in(service, request);
  if (!intake.request.study)
    throw InvalidProblem(std::vector<Fault>{
        {"/study", "is missing; it gives the meshes and schemes to solve the problem by"}});
  return intake;
}

}  // namespace signorini::server
