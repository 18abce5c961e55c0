#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "certify/membrane/membrane_rule.hpp"
#include "fem/per_shape.hpp"

namespace signorini {

/// The norms of the shapes that a mesh has often, under one constant law: for all sums over it, of a solve
/// and of the entries of its sweep. A structured mesh has a few shapes, another hardly the same twice.
///
/// Several threads may ask for norms at the same time.
///
/// Which shapes those are depends on the mesh alone, and on nothing that was summed up before: sums are the
/// same to the last bit in whatever order entries are solved.
class ShapeNorms {
 public:
  /// Looks for the shapes that come up often, the first time.
  void look_over(const Discretization& discrete);

  /// Those of a triangle's shape, made if need be; null if few triangles have it.
  const JohnsonMercierNorms* elastic(const AffineMap& map, const Spaces& spaces, LawField<2>& law);
  const MembraneNorms* membrane(const AffineMap& map, const Spaces& spaces, LawField<1>& law);
  /// Those of an elastic body if they are made.
  const JohnsonMercierNorms* made(const AffineMap& map);

 private:
  /// Made once, by whichever thread asks first.
  template <typename Norms>
  class Made {
   public:
    const Norms* get() const { return found_.load(std::memory_order_acquire); }

    template <typename Make>
    const Norms* get_or(std::mutex& mutex, const Make& make) {
      if (const Norms* found = get()) return found;
      const std::lock_guard lock(mutex);
      if (!kept_) {
        kept_ = std::make_unique<const Norms>(make());
        found_.store(kept_.get(), std::memory_order_release);
      }
      return kept_.get();
    }

   private:
    std::unique_ptr<const Norms> kept_;
    std::atomic<const Norms*> found_ = nullptr;
  };

  struct Shape {
    AffineMap map;  ///< of the first triangle, whichever asks for the norms
    int triangles = 0;
    Made<JohnsonMercierNorms> elastic = {};
    Made<MembraneNorms> membrane = {};
  };

  /// Null if few triangles have it.
  Shape* shape_of(const AffineMap& map) { return shapes_ ? shapes_->find(map.jacobian) : nullptr; }

  std::optional<ShapeMemory<Shape>> shapes_;  ///< those that come up often
  std::unique_ptr<std::mutex> makes_ = std::make_unique<std::mutex>();
};

}  // namespace signorini
