#include "scripted_solve.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <new>
#include <thread>

#include <nlohmann/json.hpp>

#include "solve.hpp"

namespace signorini::server {
namespace {

Solution solution_of(int iterations) {
  Solution solution;
  solution.summary.method = "uzawa";
  solution.summary.iterations = iterations;
  solution.summary.triangles = 2;
  for (int i = 1; i <= iterations; ++i) {
    Iteration iteration;
    iteration.number = i;
    solution.history.push_back(iteration);
  }
  return solution;
}

/// On one triangle.
Solution with_contact(int components) {
  Solution solution = solution_of(3);
  solution.components = components;
  solution.mesh = std::make_shared<const Mesh>(make_mesh(
      {{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}, {"floor", "other"}, {{{0, 1}, 0}, {{1, 2}, 1}, {{2, 0}, 1}}));
  solution.displacement = Eigen::VectorXd::Constant(components, 0.25);
  solution.displacement_at_points = Eigen::MatrixXd::Constant(components, 3, 0.25);
  solution.stress_at_centroids = Eigen::VectorXd::Constant(components + 1, 1);
  if (components == 2) solution.out_of_plane_stress = Eigen::VectorXd::Constant(1, 0);
  solution.contact = {{"floor", {{0.5, 0}}, {0}, {2.5}, {0.25}, {1}, {false}}};
  solution.summary.quantities = {{"grip", 2.5, 2.5, 2, 3, true, {}, {}}};
  return solution;
}

Solution diverged() {
  Solution solution = solution_of(3);
  solution.summary.outcome = Outcome::diverged;
  solution.summary.advice = "take a smaller rho";
  return solution;
}

/// Reports levels until it is cancelled; the last one is its answer.
Solution refine_until_cancelled(Observer& observer) {
  Solution solution = solution_of(3);
  for (int number = 1; observer.keep_going(); ++number) {
    observer.refined({number, 100 * number, 300 * number, 0.5, 0.25, 1, 0.125}, solution);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  solution.summary.outcome = Outcome::cancelled;
  solution.summary.advice = "the relative error bound is 0.25 and 0.1 was asked for";
  return solution;
}

void iterate_until(std::chrono::steady_clock::time_point end, Observer& observer) {
  observer.entered(Phase::iterate);
  for (int i = 1; std::chrono::steady_clock::now() < end; ++i) {
    if (!observer.keep_going()) throw Cancelled();
    Iteration iteration;
    iteration.number = i;
    observer.iterated(iteration);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void iterate_often(int times, Observer& observer) {
  for (int i = 1; i <= times; ++i) {
    Iteration iteration;
    iteration.number = i;
    observer.iterated(iteration);
  }
}

}  // namespace

std::string problem_titled(const std::string& title) {
  const nlohmann::json problem{
      {"title", title},
      {"model", "membrane"},
      {"domain", {{"type", "rectangle"}, {"origin", {0, 0}}, {"size", {1, 1}}}},
      {"mesh", {{"divisions", {4, 4}}, {"pattern", "right"}}},
      {"material", {{"stiffness", 1}}},
      {"load", {{"body", 1}}},
      {"boundary", {{"left", {{"type", "fixed"}}}, {"top", {{"type", "contact"}, {"gap", 0}}}}},
      {"scheme", "nonconforming"}};
  return problem.dump();
}

Solution scripted_solve(const api::Request& request, Observer& observer) {
  using namespace std::chrono_literals;
  const auto now = std::chrono::steady_clock::now();
  const std::string& title = request.title;
  if (title == "instant") return solution_of(3);
  if (title == "slow") iterate_until(now + 60s, observer);
  if (title == "short") iterate_until(now + 200ms, observer);
  if (title == "busy") iterate_often(20'000, observer);
  if (title == "large") return solution_of(100'000);
  if (title == "huge") return solution_of(600'000);
  if (title == "touches") return with_contact(1);
  if (title == "elastic") return with_contact(2);
  if (title == "diverges") return diverged();
  if (title == "refines") return refine_until_cancelled(observer);
  if (title == "throws") throw std::runtime_error("the secret of /etc/passwd");
  if (title == "no memory") throw std::bad_alloc();
  if (title == "no solution") throw SolveError("nothing holds the body");
  if (title == "not finite")
    throw InvalidProblem(std::vector<Fault>{{"/load/body", "is not finite at (1, 2)"}});
  return solution_of(1);
}

}  // namespace signorini::server
