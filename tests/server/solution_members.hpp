#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "result/solution.hpp"

namespace signorini::server {

// The members of a solution, whatever their types. A structured binding takes all members of a struct: one
// that comes to it does not compile until it is in its list here.

template <typename T, typename Of>
concept Some = std::same_as<std::remove_const_t<T>, Of>;

template <typename T>
requires Some<T, BoundaryPart> || Some<T, Circle>
auto members(T& all) {
  auto& [a, b] = all;
  return std::tie(a, b);
}
template <typename T>
requires Some<T, ContactSummary> || Some<T, Reaction>
auto members(T& all) {
  auto& [a, b, c] = all;
  return std::tie(a, b, c);
}
template <typename T>
requires Some<T, Unknowns> || Some<T, EdgePressure> || Some<T, EnclosedNumber> || Some<T, Certified>
auto members(T& all) {
  auto& [a, b, c, d] = all;
  return std::tie(a, b, c, d);
}
template <typename T>
requires Some<T, ErrorBound::Parts> || Some<T, TrueErrors> || Some<T, LevelFields> ||
    Some<T, CertifiedSupport> || Some<T, CertifiedStretch>
auto members(T& all) {
  auto& [a, b, c, d, e] = all;
  return std::tie(a, b, c, d, e);
}
template <typename T>
requires Some<T, Residuals> || Some<T, Timings>
auto members(T& all) {
  auto& [a, b, c, d, e, f] = all;
  return std::tie(a, b, c, d, e, f);
}
template <typename T>
requires Some<T, Level> || Some<T, ContactPart>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g] = all;
  return std::tie(a, b, c, d, e, f, g);
}
template <typename T>
requires Some<T, Iteration> || Some<T, Mesh>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g, h, i] = all;
  return std::tie(a, b, c, d, e, f, g, h, i);
}
/// Without the work of the loads, which is stored with what else is certified.
template <Some<ErrorBound> T>
auto members(T& all) {
  auto& [a, b, c, d, e, f, work, g] = all;
  return std::tie(a, b, c, d, e, f, g);
}
/// Without the shares of triangles, which are not stored.
template <Some<EnclosedQuantity> T>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g, shares] = all;
  return std::tie(a, b, c, d, e, f, g);
}
template <Some<StudyRow> T>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = all;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
}
template <Some<SweepEntry> T>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = all;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
}
template <Some<Summary> T>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r] = all;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r);
}
template <Some<Solution> T>
auto members(T& all) {
  auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q] = all;
  return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q);
}

/// Gives every member a value of its own.
class Filler {
 public:
  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void operator()(Number& number) { number = static_cast<Number>(++count_); }
  void operator()(bool& truth) { truth = true; }
  void operator()(Outcome& outcome) { outcome = Outcome::stalled; }
  void operator()(Scheme& scheme) { scheme = Scheme::conforming; }
  void operator()(std::string& text) { text = "text " + std::to_string(++count_); }
  template <typename Value>
  void operator()(std::optional<Value>& value) {
    (*this)(value.emplace());
  }
  template <typename Value>
  void operator()(std::vector<Value>& values) {
    values.resize(2);
    for (Value& value : values) (*this)(value);
  }
  void operator()(std::vector<bool>& values) { values = {true, false, true}; }
  template <typename Value, std::size_t n>
  void operator()(std::array<Value, n>& values) {
    for (Value& value : values) (*this)(value);
  }
  template <int rows, int columns>
  void operator()(Eigen::Matrix<double, rows, columns>& matrix) {
    matrix.resize(rows == Eigen::Dynamic ? 3 : rows, columns == Eigen::Dynamic ? 2 : columns);
    for (double& coefficient : matrix.reshaped()) (*this)(coefficient);
  }
  template <typename Value>
  void operator()(std::shared_ptr<const Value>& shared) {
    Value value;
    (*this)(value);
    shared = std::make_shared<const Value>(std::move(value));
  }
  template <typename Struct>
  void operator()(Struct& all) {
    std::apply([&](auto&... member) { ((*this)(member), ...); }, members(all));
  }

 private:
  int count_ = 1;
};

/// Whether all members are equal to the last bit.
template <typename Value>
bool are_equal(const Value& a, const Value& b);

template <typename Value>
bool are_equal(const std::vector<Value>& a, const std::vector<Value>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!are_equal(a[i], b[i])) return false;
  return true;
}
template <typename Value>
bool are_equal(const std::optional<Value>& a, const std::optional<Value>& b) {
  return a.has_value() == b.has_value() && (!a || are_equal(*a, *b));
}
template <typename Value>
bool are_equal(const std::shared_ptr<const Value>& a, const std::shared_ptr<const Value>& b) {
  return are_equal(*a, *b);
}
template <int rows, int columns>
bool are_equal(const Eigen::Matrix<double, rows, columns>& a, const Eigen::Matrix<double, rows, columns>& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
}
template <typename Value>
bool are_equal(const Value& a, const Value& b) {
  if constexpr (requires { a == b; }) {
    return a == b;
  } else {
    const auto ours = members(a), theirs = members(b);
    const auto equal = [&]<std::size_t... i>(std::index_sequence<i...>) {
      return std::array{are_equal(std::get<i>(ours), std::get<i>(theirs))...};
    }
    (std::make_index_sequence<std::tuple_size_v<decltype(ours)>>());
    for (std::size_t i = 0; i < equal.size(); ++i)
      EXPECT_TRUE(equal[i]) << "member " << i << " of a struct with " << equal.size();
    return std::ranges::all_of(equal, std::identity());
  }
}

}  // namespace signorini::server
