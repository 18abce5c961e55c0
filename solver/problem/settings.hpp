#pragma once

#include <optional>
#include <variant>

namespace signorini {

class Executor;
class Helpers;

/// The paper's Uzawa iteration (section 5) with numbers for its parameters.
struct PaperUzawa {
  double rho = 0;                   ///< step ρ of both multipliers, length² / modulus and length / modulus
  double augmentation = 0;          ///< weight r of (div σ + f, div τ), length² / modulus; 0 is allowed
  double initial_displacement = 0;  ///< u⁰, a length; the clearance starts from max(0, g − u⁰_n)
  double tolerance = 1e-5;          ///< on the paper's criterion Σ|u^{m+1} − u^m| / Σ|u^{m+1}|
  int max_iterations = 1000;
};

/// The same iteration in the limit r → ∞, ρ_u = r: the displacement is eliminated exactly, and the step on
/// the clearance remains, accelerated by conjugate gradients on what is open.
struct Mprgp {
  double tolerance = 1e-8;  ///< on every relative contact residual
  int max_iterations = 10000;
};

/// Primal-dual active set on the contact complement; exact to rounding.
struct ActiveSet {
  int max_iterations = 1000;  ///< dense steps
};

using Method = std::variant<Mprgp, PaperUzawa, ActiveSet>;

/// Which code factors: ours or CHOLMOD's. The answers are the same, but for rounding; time and memory are
/// not.
enum class Factorization { multifrontal, cholmod };

struct Settings {
  Method method = Mprgp{};
  std::optional<double> time_limit;  ///< seconds for the whole solve
  double spent = 0;  ///< seconds that count for the limit, but were before the solve: reading the problem
  Factorization factorization = Factorization::multifrontal;  ///< of whoever solves, not of the problem
  bool entries_alone =
      false;  ///< only the entries of the sweep are asked for, not the problem's own solution
  Helpers* helpers = nullptr;    ///< with the sweep, if there are any
  Executor* executor = nullptr;  ///< on cores that nobody else wants, if there are any
  int threads = 1;  ///< that are at work in the solve at most: its own, and those of the executor
};

}  // namespace signorini
