#pragma once

#include <string_view>

#include "api/result/result_members.hpp"
#include "solve.hpp"

namespace signorini::api {

/// The members of a result that a client may pick; `summary` is always there.
struct ResultFields {
  bool problem = true;
  bool mesh = true;
  bool displacement = true;
  bool stress = true;
  bool contact = true;
  bool history = true;
  bool sweep = true;       ///< if the problem has one
  bool study = true;       ///< if the problem has one
  bool quantities = true;  ///< if the problem asks for some
  // Only by name: they follow from the stress, and there are none for a membrane.
  bool principal = false;
  bool von_mises = false;
  bool error_squares = false;  ///< only by name, if there is an error bound
  bool levels = false;         ///< only by name, if the mesh refined itself

  /// Reads a comma separated list such as `summary,contact`; an empty list is the default set. Throws
  /// InvalidProblem (with the pointer `/fields`) for a name that is unknown, and names those that are known.
  static ResultFields parse(std::string_view list);

  /// Throws InvalidProblem (with the pointer `/fields`) if a result with so many components of the
  /// displacement (1: a membrane, 2: an elastic body) cannot have a picked member.
  void require_available(int components) const;
};

/// The part of a result that does not come from the solution. Refers to texts that live as long as it is
/// written.
struct ResultHead {
  std::string_view id;               ///< empty: the member is left out
  std::string_view status;           ///< `succeeded` or `failed`
  std::string_view problem_json;     ///< the problem as the client sent it
  std::string_view error_json = {};  ///< why it did not succeed; empty: the member is left out
};

/// Writes the result document (api/README.md, "A result"). Throws InvalidProblem, before it writes anything,
/// for fields that the solution cannot have.
void write_result(DocumentWriter& out, const ResultHead& head, const Solution& solution,
                  const ResultFields& fields);

/// What POST /v1/validate answers for a problem without faults; `left` says what is left to the solve.
void write_estimates(DocumentWriter& out, const Estimates& foreseen,
                     const std::vector<std::string>& left = {});

}  // namespace signorini::api
