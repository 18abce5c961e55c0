#include "server/jobs/postgres/url.hpp"

#include <regex>

namespace signorini::server::postgres {

std::string without_password(const std::string& text) {
  static const std::regex before_host(R"((postgres(?:ql)?://[^/@:\s]*):[^"\s]*@)");
  static const std::regex parameter(R"--(([?&])(?:ssl)?password=[^&"'\s]*&?)--");
  return std::regex_replace(std::regex_replace(text, before_host, "$1@"), parameter, "$1");
}

}  // namespace signorini::server::postgres
