#pragma once

#include <string>
#include <vector>

#include "problem/field.hpp"

/// The faults that the action throws as InvalidProblem; none if it throws nothing.
template <typename Action>
std::vector<signorini::Fault> faults_of(const Action& action) {
  try {
    action();
  } catch (const signorini::InvalidProblem& invalid) {
    return invalid.faults();
  }
  return {};
}

/// The pointers of the faults, in their order.
inline std::vector<std::string> pointers_of(const std::vector<signorini::Fault>& faults) {
  std::vector<std::string> pointers;
  for (const signorini::Fault& fault : faults) pointers.push_back(fault.where);
  return pointers;
}
