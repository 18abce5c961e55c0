#include "server/handlers/batch_intake.hpp"

#include <ctime>

#include <openssl/sha.h>

#include "api/problem/batch_json.hpp"
#include "server/handlers/intake.hpp"
#include "server/handlers/submission.hpp"
#include "server/http/error.hpp"

namespace signorini::server {
namespace {

/// Seconds of a core. A thousand problems of the examples' kind take a part of it; others wait for the
/// thread.
constexpr double longest_reading = 3;

double seconds_of_this_thread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

HttpError too_long_to_read(const std::string& pointer) {
  const std::string detail = "Reading the batch took more than " +
                             std::to_string(static_cast<int>(longest_reading)) +
                             " s of a core up to this problem. Split the batch here.";
  return {
      413,
      {"batch-takes-too-long", "The batch takes too long to read", detail, {{"pointer", pointer, detail}}}};
}

std::string digest_of(const std::string& text) {
  std::string digest(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(),
         reinterpret_cast<unsigned char*>(digest.data()));
  std::string words;
  for (const char c : digest) {
    const auto byte = static_cast<unsigned char>(c);
    words.append(1, "0123456789abcdef"[byte >> 4]).append(1, "0123456789abcdef"[byte & 15]);
  }
  return words;
}

/// What is wrong with the problem at the pointer, told of the batch.
HttpError within_batch(HttpError error, const std::string& pointer) {
  for (FaultItem& item : error.details.errors) item.where = pointer + item.where;
  return error;
}

NewBatch read(Service& service, const Request& request, const std::string& text) {
  const double begun = seconds_of_this_thread();
  NewBatch taken;
  const auto read_problem = [&](const api::Batch& batch, std::string_view problem,
                                const std::string& pointer) {
    if (seconds_of_this_thread() - begun > longest_reading) throw too_long_to_read(pointer);
    try {
      Intake intake = judge(std::string(problem), request, service.limits);
      api::add_tags(batch.tags, intake.request.tags);
      taken.jobs.push_back(new_job(service, request, std::move(intake)));
    } catch (const HttpError& error) {
      throw within_batch(error, pointer);
    }
  };
  taken.batch.id = service.ids.next();
  api::Batch batch = api::parse_batch(text, read_problem);
  taken.batch.title = std::move(batch.title);
  taken.batch.tags = std::move(batch.tags);
  taken.batch.owner = request.identity.name;
  taken.batch.created = std::chrono::system_clock::now();
  for (NewJob& job : taken.jobs) {
    job.batch = taken.batch.id;
    taken.batch.jobs.push_back(job.id);
  }
  taken.digest = digest_of(text);
  return taken;
}

}  // namespace

NewBatch take_in_batch(Service& service, const Request& request) {
  const std::string text = json_body(request, service.limits.max_body_bytes);
  const ReleasedMemory released(text.size());
  try {
    return read(service, request, text);
  } catch (const Cancelled&) {
    throw client_left();
  }
}

}  // namespace signorini::server
