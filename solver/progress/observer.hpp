#pragma once

#include <cstddef>
#include <exception>
#include <optional>
#include <stdexcept>

namespace signorini {

struct Solution;

/// What a solve is doing.
enum class Phase { mesh, assemble, factorize, iterate, certify };

/// The name of the phase: `mesh`, `assemble`, `factorize`, `iterate`, `certify`.
const char* name(Phase phase);

/// One iteration of a method; all residuals are relative, without unit.
struct Iteration {
  int number = 0;                             ///< from 1
  std::optional<double> displacement_change;  ///< Σ|u^{m+1} − u^m| / Σ|u^{m+1}|, the paper's form only
  double clearance_change = 0;                ///< Σ|λ^{m+1} − λ^m| / Σ|λ^{m+1}|
  double equilibrium = 0;                     ///< ‖div σ + f‖; 0 where the displacement is eliminated
  double penetration = 0;
  double tension = 0;
  double complementarity = 0;
  int active = 0;      ///< closed contact unknowns (λ = 0)
  double seconds = 0;  ///< since the start of the solve
};

/// One mesh of a solve that refines its mesh by itself.
struct Level {
  int number = 0;  ///< from 1
  int triangles = 0;
  int unknowns = 0;     ///< of all fields
  double bound = 0;     ///< of the error in the energy norm
  double relative = 0;  ///< to the energy norm of the stress
  int iterations = 0;
  double seconds = 0;  ///< since the start of the solve
};

/// Watches a solve from the thread that runs it, and may end it.
class Observer {
 public:
  virtual ~Observer() = default;

  virtual void entered(Phase) {}
  virtual void iterated(const Iteration&) {}
  /// A mesh that refines itself was solved on this level; the solution is there during the call.
  virtual void refined(const Level&, const Solution&) {}
  /// Whether entry() is to be called, for which the fields of every entry of a sweep are computed.
  virtual bool sees_entries() const { return false; }
  /// An entry of a sweep was solved, the first one being 0; the solution is there during the call.
  virtual void entry(std::size_t /*number*/, const Solution&) {}
  /// So many entries of a sweep are done. Phases and iterations are those of the problem itself.
  virtual void swept(std::size_t /*done*/, std::size_t /*count*/) {}
  /// So many runs of a study are done.
  virtual void studied(std::size_t /*done*/, std::size_t /*count*/) {}

  /// Asked often; false ends the solve with Cancelled.
  virtual bool keep_going() { return true; }
};

/// Shows the observer of a whole solve nothing of a part of it, but lets it end the part.
class SilentObserver : public Observer {
 public:
  explicit SilentObserver(Observer& whole) : whole_(whole) {}
  bool keep_going() override { return whole_.keep_going(); }

 private:
  Observer& whole_;
};

/// A problem that is well posed as text but has no solution, or none that this machine can compute: a
/// body that nothing holds, a contact that can never be met, a matrix that is too large. The text names
/// the cause and the remedy.
class SolveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The time limit was reached before there was any iterate, or its error bound.
struct TimeUp : SolveError {
  using SolveError::SolveError;
};

/// Thrown out of a solve whose observer asked it to end.
struct Cancelled : std::exception {
  const char* what() const noexcept override { return "the solve was cancelled"; }
};

}  // namespace signorini
