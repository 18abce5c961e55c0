#pragma once

namespace signorini::server {

/// Lets the process open as many files and connections as it may: the usual limit of 1024 is one of old
/// programs that could not count further, which this one is not.
void raise_descriptor_limit();

}  // namespace signorini::server
