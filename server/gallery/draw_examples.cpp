// Draws the pictures of the start page while the service is built, so that they are there at once and no
// thread of the service solves for them. `draw_examples DIRECTORY`

#include <fstream>
#include <iostream>
#include <string>

#include "api/document/gzip.hpp"
#include "api/examples.hpp"
#include "api/picture/picture.hpp"
#include "api/problem/problem_json.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

/// So that the largest displacement is a share of the body that is seen.
double deformation(const Solution& solution) {
  constexpr double seen = 0.05;
  Point low = solution.mesh->points.front(), high = low;
  for (const Point& point : solution.mesh->points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return seen * (high - low).maxCoeff() / solution.displacement_at_points.cwiseAbs().maxCoeff();
}

/// A membrane by its displacement, a body by von Mises' stress.
api::Picture picture_of(const Problem& problem, const Solution& solution) {
  if (solution.components == 1) return {};
  return {api::Picture::Field::von_mises, deformation(solution), api::Picture::contacts_of(problem)};
}

void draw(const api::Example& example, const std::string& directory) {
  const api::Request request = api::parse_request(example.json);
  const Solution solution = solve(request.problem, request.settings);
  std::ofstream file(directory + "/" + std::string(example.name) + ".svg.gz", std::ios::binary);
  file.exceptions(std::ios::badbit | std::ios::failbit);
  const api::Sink to_file = [&](std::string_view piece) {
    file << piece;
    return true;
  };
  api::Gzip gzip(to_file, api::Effort::most);
  api::write_picture(solution, picture_of(request.problem, solution),
                     [&](std::string_view piece) { return gzip.put(piece); });
  gzip.finish();
}

}  // namespace
}  // namespace signorini

int main(int, char** arguments) {
  try {
    for (const auto& example : signorini::api::examples()) signorini::draw(example, arguments[1]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "draw_examples: " << error.what() << '\n';
    return 1;
  }
}
