#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "certify/reactions/extensions.hpp"
#include "result/solution.hpp"

namespace signorini {

/// Encloses what supports take, by the bound of the stress and an extension of their motion: THEORY.md,
/// Theorem 5.
class Reactions {
 public:
  /// Of a solution with a bound. All must outlive it. Throws what Progress throws, as all() does.
  Reactions(const Discretization& discrete, const Solution& solution, const Extensions& extensions,
            Progress& progress);

  /// Of each support, then of those together that clash in a point. Adds to `unmet` why a number is not
  /// bounded.
  std::vector<CertifiedSupport> all(std::vector<std::string>& unmet, Progress& progress) const;

 private:
  int components() const { return discrete_.spaces().components; }
  void add(int point, int component, double work);
  template <int D>
  void add_stress(Progress& progress);
  void add_load(int t);
  void add_traction(int edge);
  double uncertain_work(const Eigen::MatrixXd& at_points) const;
  EnclosedNumber enclose(const Extension& extension, double value) const;
  std::vector<SupportMotion> motions() const;
  CertifiedSupport of(int part, std::vector<Extension::Clash>& clashes, Progress& progress) const;
  CertifiedSupport of(const std::vector<int>& parts, std::vector<Extension::Clash>& clashes,
                      Progress& progress) const;
  EnclosedNumber pressure_force(int part, Progress& progress) const;
  EnclosedNumber force_under(int part, Extensions::Hat hat,
                             const std::function<double(int point)>& weight) const;
  CertifiedStretch stretch(int part, std::span<const std::array<int, 2>> ways,
                           std::span<const int> edges) const;
  std::vector<CertifiedStretch> stretches(int part) const;
  std::optional<double> most_opening(std::span<const int> edges) const;

  const Discretization& discrete_;
  const Solution& solution_;
  const Extensions& extensions_;
  /// (σ_h, ε(φ)) − (f, φ) − <t, φ> for the hats φ of the points, and all its terms with one sign.
  Eigen::MatrixXd work_, size_;
  /// Of the loads, by triangles and edges; those that are known are left out.
  std::vector<std::pair<int, double>> uncertain_on_triangles_, uncertain_on_edges_;
  std::map<int, double> least_pressure_;  ///< of p*, by edges
};

}  // namespace signorini
