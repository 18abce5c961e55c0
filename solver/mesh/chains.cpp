#include "mesh/chains.hpp"

#include <algorithm>
#include <numeric>

namespace signorini {
namespace {

/// Edges not yet taken, by the point where they begin.
class Outgoing {
 public:
  explicit Outgoing(const std::vector<std::array<int, 2>>& edges)
      : edges_(edges), by_begin_(edges.size()), taken_(edges.size(), false) {
    std::iota(by_begin_.begin(), by_begin_.end(), 0);
    std::ranges::stable_sort(by_begin_, {}, [&](int i) { return edges_[i][0]; });
  }

  bool is_taken(int edge) const { return taken_[edge]; }

  /// Appends the edge and those that follow it.
  void take_chain(int edge, std::vector<std::array<int, 2>>& chain) {
    while (edge >= 0) {
      taken_[edge] = true;
      chain.push_back(edges_[edge]);
      edge = first_at(edges_[edge][1]);
    }
  }

 private:
  int first_at(int point) const {
    const auto begin = [&](int i) { return edges_[i][0]; };
    for (auto i = std::ranges::lower_bound(by_begin_, point, {}, begin);
         i != by_begin_.end() && begin(*i) == point; ++i)
      if (!taken_[*i]) return *i;
    return -1;
  }

  const std::vector<std::array<int, 2>>& edges_;
  std::vector<int> by_begin_;
  std::vector<bool> taken_;
};

std::vector<int> ends_of(const std::vector<std::array<int, 2>>& edges) {
  std::vector<int> ends;
  for (const auto& edge : edges) ends.push_back(edge[1]);
  std::ranges::sort(ends);
  return ends;
}

}  // namespace

std::vector<std::array<int, 2>> in_chains(const std::vector<std::array<int, 2>>& edges) {
  Outgoing outgoing(edges);
  std::vector<std::array<int, 2>> chains;
  const std::vector<int> ends = ends_of(edges);
  const auto number = static_cast<int>(edges.size());
  for (int i = 0; i < number; ++i)
    if (!std::ranges::binary_search(ends, edges[i][0]) && !outgoing.is_taken(i))
      outgoing.take_chain(i, chains);
  // What remains is closed, or begins where another chain ends.
  for (int i = 0; i < number; ++i)
    if (!outgoing.is_taken(i)) outgoing.take_chain(i, chains);
  return chains;
}

}  // namespace signorini
