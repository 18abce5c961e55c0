#pragma once

#include <map>
#include <mutex>

#include "problems/elasticity.hpp"

/// Problems that differ in their data alone, shared by the tests of reuse.
namespace signorini::problems {

/// Keeps every operator.
class Shelf : public OperatorCache {
 public:
  std::shared_ptr<const Operator> find(const std::string& key) override {
    const std::lock_guard lock(mutex_);
    const auto found = kept_.find(key);
    return found == kept_.end() ? nullptr : found->second;
  }
  bool keep(const std::string& key, std::shared_ptr<const Operator> made) override {
    const std::lock_guard lock(mutex_);
    kept_[key] = std::move(made);
    return true;
  }
  std::size_t size() const { return kept_.size(); }

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const Operator>> kept_;
};

inline Field wave(std::mt19937& engine, double mean, double size) {
  std::uniform_real_distribution<> number(-4, 4);
  const double a = number(engine), b = number(engine), phase = number(engine);
  return wave(mean, size, a, b, phase);
}

/// The problem with other gaps, loads, tractions and boundary values, its kinds of conditions as they were.
inline Problem with_other_data(Problem problem, unsigned seed) {
  std::mt19937 engine(seed);
  const bool elastic = components(problem.material) == 2;
  const auto field = [&](double mean, double size) {
    return elastic ? VectorField(wave(engine, 0, size), wave(engine, mean, size))
                   : VectorField(wave(engine, mean, size));
  };
  problem.body = field(-8, 3);
  for (auto& [part, condition] : problem.boundary) {
    if (auto* contact = std::get_if<Contact>(&condition)) contact->gap = wave(engine, 0.04, 0.04);
    if (auto* fixed = std::get_if<Fixed>(&condition)) fixed->value = field(0.3, 0.1);
    if (auto* traction = std::get_if<Traction>(&condition)) traction->value = field(-1, 1);
  }
  return problem;
}

inline Problem elastic(Scheme scheme, double poisson) {
  Problem problem = block(scheme, Pattern::alternating, 3, poisson);
  problem.mesh.fineness = Divisions{11, 7};
  problem.boundary = {{"left", Roller{}}, {"bottom", Contact{}}, {"right", Contact{}}, {"top", Traction{}}};
  return problem;
}

inline std::vector<Problem> families() {
  std::vector<Problem> families;
  for (unsigned seed = 1; seed < 5; ++seed) families.push_back(random(seed));
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    families.push_back(paper(scheme, 9));
    families.push_back(elastic(scheme, 0.3));
    Problem along_a_direction = elastic(scheme, 0.3);
    along_a_direction.boundary["bottom"] = Contact{0, Vector(0.4, -1)};
    families.push_back(along_a_direction);
    Problem held_by_contact_alone = paper(scheme, 8);
    held_by_contact_alone.boundary = {{"bottom", Contact{}}, {"top", Contact{}}};
    families.push_back(held_by_contact_alone);
  }
  return families;
}

}  // namespace signorini::problems
