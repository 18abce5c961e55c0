#pragma once

#include <string>
#include <vector>

namespace signorini::server {

/// What becomes of a connection.
enum class After { goes_on, closes };

/// One line of the table of conformance.
struct Case {
  std::string name;
  std::string bytes;
  std::vector<int> statuses;  ///< of all replies, interim ones included
  After after = After::goes_on;
  std::string says = {};  ///< somewhere in what is heard
  std::string then = {};  ///< sent after the first reply
};

/// The cases of one subject.
struct CaseGroup {
  std::string name;
  std::vector<Case> cases;
};

std::vector<CaseGroup> case_groups();

}  // namespace signorini::server
