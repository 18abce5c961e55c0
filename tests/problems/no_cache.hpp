#pragma once

#include "contact/operator.hpp"

namespace signorini {

/// Keeps no operator.
struct NoCache : OperatorCache {
  std::shared_ptr<const Operator> find(const std::string&) override { return nullptr; }
  bool keep(const std::string&, std::shared_ptr<const Operator>) override { return false; }
};

}  // namespace signorini
