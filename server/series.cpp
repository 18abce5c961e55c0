#include "server/series.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "api/result/vtu.hpp"
#include "server/local_solve.hpp"

namespace signorini::server {
namespace {

template <typename Write>
void write_file(const std::string& path, const Write& write) {
  std::ofstream file(path, std::ios::binary);
  const bool written = write([&](std::string_view piece) {
    return static_cast<bool>(file.write(piece.data(), static_cast<std::streamsize>(piece.size())));
  });
  if (!written || !file.flush())
    throw BadInput{{"unwritable-file", "A file cannot be written", "Cannot write " + path + " (--series)."}};
}

std::string numbered(const char* what, std::size_t number) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%s-%04zu.vtu", what, number);
  return text.data();
}

}  // namespace

Series::Series(std::string directory) : directory_(std::move(directory)) {
  std::error_code error;
  std::filesystem::create_directories(directory_, error);
  if (error)
    throw BadInput{{"unwritable-file", "A file cannot be written",
                    "Cannot make the directory " + directory_ + " (--series): " + error.message() + "."}};
}

void Series::add_level(const Level& level, const Solution& solution) {
  add(level.number, numbered("level", static_cast<std::size_t>(level.number)), solution);
}

void Series::add_entry(std::size_t number, const Solution& solution) {
  add(static_cast<double>(number), numbered("entry", number), solution);
}

void Series::add(double time, const std::string& name, const Solution& solution) {
  write_file(directory_ + '/' + name, [&](const api::Sink& sink) { return api::write_vtu(solution, sink); });
  files_.push_back({time, name});
}

void Series::finish() {
  std::ranges::sort(files_, {}, &api::SeriesFile::time);
  write_file(directory_ + "/series.pvd", [&](const api::Sink& sink) { return api::write_pvd(files_, sink); });
}

}  // namespace signorini::server
