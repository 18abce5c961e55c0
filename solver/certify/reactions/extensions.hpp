#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "certify/data/law_pieces.hpp"
#include "fem/discretization.hpp"
#include "mesh/triangles_at_points.hpp"
#include "problem/settings.hpp"
#include "system/element_sum.hpp"
#include "system/factor.hpp"

namespace signorini {

/// A displacement that is linear on the triangles.
struct Extension {
  Eigen::MatrixXd at_points;  ///< a column a point of the mesh
  double energy_square = 0;   ///< ‖ε(w)‖²_E, or more where the stiffness varies
  /// A point in which a support that moves meets another that does not let it: there it is 0.
  struct Clash {
    int part, other, point;
  };
  std::vector<Clash> clashes;
};

/// Extends what supports do into the body, with about the least energy that is linear on the triangles. A
/// support is a part that is fixed, on rollers or in contact: it holds all components, or the one along the
/// direction of its condition.
class Extensions {
 public:
  /// All must outlive it. `tree`: how the triangles were cut into pieces before, if they were. Throws what
  /// factorize() throws.
  Extensions(const Discretization& discrete, const LawOnMesh& laws, Factorization by, Progress& progress,
             std::shared_ptr<const ElementTree> tree = {});

  /// Of each support, its number in mesh.boundary.
  const std::vector<int>& supports() const { return supports_; }

  /// What is given at a point of the mesh along the direction that a support holds there.
  using Given = std::function<double(int point, const Vector& direction)>;
  /// What is given on the parts that move, and 0 on all other supports.
  Extension operator()(const std::vector<int>& moved, const Given& given, Progress& progress) const;

  /// Where it clashes, without a solve.
  std::vector<Extension::Clash> clashes(const std::vector<int>& moved, const Given& given) const;

  /// A function that falls from 1 on a segment to 0 at a distance, and what is to be reached on the segment.
  struct Hat {
    Point begin, end;
    double reach;
    Vector top;

    double operator()(const Point& x) const;
  };
  /// What is given on a part, 0 on all other supports, and beside them a hat as far as it hangs together with
  /// what is given: not of the least energy, but without a solve, and where it is 0 without a look.
  Extension tent(int part, const Given& given, const Hat& hat) const;

 private:
  /// What a support holds in a point.
  struct Hold {
    int part;
    Vector direction;
    double rounding;  ///< the angle by which it may be turned
  };

  int components() const { return discrete_.spaces().components; }
  void hold_parts();
  static const Hold* other_direction(const std::vector<Hold>& holds);
  template <int D>
  void add_elements(const LawOnMesh& laws, Progress& progress);
  Eigen::MatrixXd turned(int t, Eigen::MatrixXd element) const;
  std::optional<Vector> met(int point, const std::vector<int>& moved, const Given& given) const;
  Eigen::MatrixXd held(const std::vector<int>& moved, const Given& given,
                       std::vector<Extension::Clash>& clashes) const;
  template <int D>
  Eigen::Matrix<double, 3 * D, 1> local(int t, const Eigen::MatrixXd& w) const;
  template <int D>
  void complete(Eigen::MatrixXd& w, Progress& progress) const;
  template <int D>
  double energy_square(int t, const Eigen::MatrixXd& w) const;
  double energy_square(int t, const Eigen::MatrixXd& w) const;
  void turn_back(Eigen::MatrixXd& w) const;

  const Discretization& discrete_;
  const TrianglesAtPoints triangles_;
  std::vector<int> supports_;
  std::map<int, std::vector<Hold>> holds_;  ///< by points
  std::map<int, Eigen::Matrix2d> turns_;  ///< of points that are held along one direction, which comes first
  std::vector<bool> is_turned_;           ///< an entry a triangle: one of its points is
  std::vector<int> unknowns_;             ///< of the components of each point; -1 where they are held
  ElementSum stiffness_;
  std::optional<Factor> factor_;
};

}  // namespace signorini
