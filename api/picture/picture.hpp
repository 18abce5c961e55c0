#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "api/document/piece_writer.hpp"
#include "result/solution.hpp"

namespace signorini::api {

/// What a picture shows of a solution.
struct Picture {
  /// The body in the plane, coloured by
  /// - `displacement`: u_h of a membrane, |u_h| of an elastic body;
  /// - `stress`: |σ_h| of a membrane at the centroids, of a body the principal stress that is larger in size;
  /// - `von_mises`: of an elastic body, at the centroids;
  /// - `error`: what a triangle adds to the error bound, as the root of its share of the square;
  /// or curves: `contact`, pressure and clearance along each part by arc length; `history`, the residuals of
  /// each iteration.
  enum class Field { displacement, stress, von_mises, error, contact, history };

  Field field = Field::displacement;
  /// The points are moved by so many times the displacement of an elastic body, from 0 to most_deformed;
  /// nothing: they stay. Foundations are drawn so many times as far away as the gap is, else where it is.
  std::optional<double> deformed;
  /// The contacts of the problem by their parts, for the directions in which foundations lie.
  std::map<std::string, Contact> contacts = {};

  static constexpr double most_deformed = 1e15;

  /// `displacement` and so on; empty is `displacement`. Throws InvalidProblem at `/field`.
  static Field field_named(std::string_view name);

  static std::map<std::string, Contact> contacts_of(const Problem& problem);

  /// Throws InvalidProblem at `/field` or `/deformed` for what solutions with so many components do not have.
  void require_available(int components) const;
  /// The same for one solution, which may have no error bound.
  void require_available(const Solution& solution) const;
};

/// Writes the picture as SVG 1.1: stress and P0 displacements have one colour in each triangle, linear
/// displacements bands of colour, jumps stay jumps. The picture must be available. Returns false if the sink
/// ended it.
bool write_picture(const Solution& solution, const Picture& picture, const Sink& sink);

}  // namespace signorini::api
