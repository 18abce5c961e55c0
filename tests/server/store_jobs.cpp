#include "store_jobs.hpp"

#include <random>

namespace signorini::server {

NewJob new_job(const std::string& id, const std::string& problem, const std::optional<std::string>& key) {
  NewJob job;
  job.id = id;
  job.created = std::chrono::system_clock::now();
  job.problem = std::make_shared<const std::string>(problem);
  job.key = key;
  return job;
}

Ending success(std::size_t bytes) {
  static thread_local std::mt19937_64 random;
  auto solution = std::make_shared<Solution>();
  solution->summary.iterations = 3;
  solution->history.resize(3);
  solution->history.back().number = 3;
  solution->displacement_at_points.resize(1, static_cast<Eigen::Index>(bytes / sizeof(double)));
  for (double& value : solution->displacement_at_points.reshaped()) {
    value = std::uniform_real_distribution<double>(-1e9, 1e9)(random);
  }
  Ending ending;
  ending.status = JobStatus::succeeded;
  ending.solution = solution;
  ending.history = {solution, &solution->history};
  return ending;
}

std::vector<std::string> ids(const JobPage& page) {
  std::vector<std::string> list;
  for (const Job& each : page.jobs) list.push_back(each.id);
  return list;
}

}  // namespace signorini::server
