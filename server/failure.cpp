#include "server/failure.hpp"

#include <new>

#include <spdlog/spdlog.h>

#include "api/document/cbor_document.hpp"
#include "api/document/json_document.hpp"
#include "server/jobs/store.hpp"
#include "solve.hpp"

namespace signorini::server {
namespace {

std::string faults_in_words(std::size_t count) {
  if (count == 1) return "The problem has 1 fault; it is listed in `errors`.";
  return "The problem has " + std::to_string(count) + " faults; they are listed in `errors`.";
}

std::vector<FaultItem> pointer_items(const std::vector<Fault>& faults) {
  std::vector<FaultItem> items;
  items.reserve(faults.size());
  for (const Fault& fault : faults) items.push_back({"pointer", fault.where, fault.detail});
  return items;
}

Failure internal_error() {
  return {500, {"internal-error", "Internal error", "The service failed; its log says more."}};
}

}  // namespace

Failure describe(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const api::MalformedJson& malformed) {
    return {400, {"malformed-json", "The body is not JSON", malformed.what()}};
  } catch (const api::MalformedCbor& malformed) {
    return {400, {"malformed-cbor", "The body is not CBOR", malformed.what()}};
  } catch (const InvalidProblem& invalid) {
    return {422,
            {"invalid-problem", "The problem cannot be solved as posed",
             faults_in_words(invalid.faults().size()), pointer_items(invalid.faults())}};
  } catch (const TimeUp& late) {
    return {422, {"time-limit", "The time limit was reached before there was an answer", late.what()}};
  } catch (const SolveError& unsolvable) {
    return {422, {"no-solution", "The problem has no solution that can be computed", unsolvable.what()}};
  } catch (const Cancelled&) {
    return {409, {"cancelled", "The solve was cancelled", "The solve was cancelled before it ended."}};
  } catch (const StoreUnavailable& unavailable) {
    return {503,
            {"store-unavailable", "Solves cannot be kept for now",
             "No solve is taken or changed while " + std::string(unavailable.what()) + "."}};
  } catch (const std::bad_alloc&) {
    return {
        503,
        {"out-of-memory", "Out of memory",
         "The machine ran out of memory. Take a coarser mesh or the nonconforming scheme, or run the service "
         "with fewer workers or more memory; POST /v1/validate estimates the memory of a problem."}};
  } catch (const std::exception& unforeseen) {
    spdlog::error("nobody foresaw this failure: {}", unforeseen.what());
  } catch (...) {
    spdlog::error("nobody foresaw this failure: an exception that is no std::exception");
  }
  return internal_error();
}

}  // namespace signorini::server
