#include "server/jobs/postgres/rows.hpp"

#include <algorithm>
#include <cctype>

#include "server/jobs/stored_form.hpp"

namespace signorini::server::postgres {

const std::string job_columns =
    "id, status, title, created, started, finished, verdict, trace, owner, tags, batch, whole, first_entry, "
    "entries";

std::optional<Time> time_of(const Rows& rows, int row, int column) {
  if (rows.is_null(row, column)) return std::nullopt;
  return Time(std::chrono::milliseconds(rows.integer(row, column)));
}

Job job_of(const Rows& rows, int row) {
  Job job;
  job.id = rows.text(row, 0);
  job.owner = rows.text(row, 8);
  job.status = job_status(rows.view(row, 1)).value_or(JobStatus::failed);
  job.title = rows.text(row, 2);
  job.created = time_of(rows, row, 3).value_or(Time());
  job.started = time_of(rows, row, 4);
  job.finished = time_of(rows, row, 5);
  job.trace = rows.text(row, 7);
  job.batch = rows.text(row, 10);
  if (!rows.is_null(row, 11))
    job.chunk = {rows.text(row, 11), static_cast<std::size_t>(rows.integer(row, 12)),
                 static_cast<std::size_t>(rows.integer(row, 13))};
  try {
    job.tags = unpack_list(rows.text(row, 9));
    if (!rows.is_null(row, 6)) job.verdict = unpack_verdict(rows.text(row, 6));
  } catch (const std::exception&) {
    job.status = JobStatus::failed;
    job.verdict = verdict_of(damaged_ending("entry in the list of solves"));
  }
  return job;
}

const std::string batch_columns = "id, owner, created, content";

std::optional<Batch> batch_of(const Rows& rows, int row) try {
  Batch batch;
  batch.id = rows.text(row, 0);
  batch.owner = rows.text(row, 1);
  batch.created = time_of(rows, row, 2).value_or(Time());
  unpack_content(rows.text(row, 3), batch);
  return batch;
} catch (const std::exception&) {
  return std::nullopt;
}

bool may_be_an_id(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) { return std::isalnum(c); });
}

std::shared_ptr<const std::string> problem_of(const std::string& packed) {
  try {
    return std::make_shared<const std::string>(unpack_text(packed));
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

}  // namespace signorini::server::postgres
