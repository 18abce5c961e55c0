#pragma once

#include <string>

namespace signorini::server::postgres {

/// A text to be shown without the passwords of the URLs postgresql://… in it.
std::string without_password(const std::string& text);

}  // namespace signorini::server::postgres
