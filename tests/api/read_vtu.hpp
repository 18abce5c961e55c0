#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace signorini::api {

/// A .vtu file with appended raw data, read by what the format says and not by what the writer does.
struct Vtu {
  struct Array {
    std::string section, type, attributes;
    std::string bytes;
    std::uint64_t offset = 0;

    template <typename Number>
    std::vector<Number> as() const {
      std::vector<Number> numbers(bytes.size() / sizeof(Number));
      std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
      return numbers;
    }
    std::vector<double> doubles() const {
      EXPECT_EQ(type, "Float64");
      return as<double>();
    }
    std::vector<std::int64_t> integers() const {
      EXPECT_EQ(type, "Int64");
      return as<std::int64_t>();
    }
  };

  std::string head;  ///< everything before the data
  std::string data;
  std::map<std::string, Array> arrays;
};

inline std::string attribute(const std::string& tag, const std::string& name) {
  std::smatch found;
  return std::regex_search(tag, found, std::regex("\\b" + name + "=\"([^\"]*)\"")) ? found[1].str() : "";
}

inline Vtu read_vtu(const std::string& file) {
  static_assert(std::endian::native == std::endian::little);
  const std::string opening = "<AppendedData encoding=\"raw\">\n_",
                    closing = "\n  </AppendedData>\n</VTKFile>\n";
  const std::size_t begin = file.find(opening) + opening.size();
  EXPECT_TRUE(file.ends_with(closing));
  Vtu vtu{file.substr(0, begin), file.substr(begin, file.size() - begin - closing.size()), {}};
  const std::regex element("<(PointData|CellData|Points|Cells|DataArray)\\b[^>]*>");
  std::string section;
  for (std::sregex_iterator i(vtu.head.begin(), vtu.head.end(), element), end; i != end; ++i) {
    const std::string tag = i->str();
    if ((*i)[1] != "DataArray") {
      section = (*i)[1];
      continue;
    }
    EXPECT_EQ(attribute(tag, "format"), "appended");
    Vtu::Array array{section, attribute(tag, "type"), tag, {}, std::stoull(attribute(tag, "offset"))};
    std::uint64_t size = 0;
    std::memcpy(&size, vtu.data.data() + array.offset, sizeof size);
    array.bytes = vtu.data.substr(array.offset + sizeof size, size);
    EXPECT_EQ(array.bytes.size(), size) << tag;
    vtu.arrays.emplace(attribute(tag, "Name"), array);
  }
  return vtu;
}

}  // namespace signorini::api
