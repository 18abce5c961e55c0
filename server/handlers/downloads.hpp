#pragma once

#include "server/handlers/service.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// The media type of a .vtu file. None is registered for VTK's formats, and with its raw data the file is no
/// XML document, so that no XML type would be true.
inline constexpr const char* vtu_media_type = "application/vnd.vtk";

/// A result as files for other programs; each has the errors of the result itself (404, 409, 410).
Response get_result_vtu(Service& service, const Request& request);

inline constexpr const char* svg_media_type = "image/svg+xml";

/// The picture that `field` and `deformed` in the query ask for.
Response get_picture(Service& service, const Request& request);
Response get_history_csv(Service& service, const Request& request);
Response get_contact_csv(Service& service, const Request& request);
Response get_quantities_csv(Service& service, const Request& request);
/// 404 too if the problem has no study.
Response get_study_csv(Service& service, const Request& request);

}  // namespace signorini::server
