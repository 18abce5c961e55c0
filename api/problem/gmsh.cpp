#include "api/problem/gmsh.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "api/limits.hpp"
#include "api/problem/gmsh_text.hpp"
#include "api/wording.hpp"

namespace signorini::api {
namespace {

using Tag = std::int64_t;

struct Node {
  Tag tag = 0;
  Point x{0, 0};
  double z = 0;
  int text_line = 0;
};

template <std::size_t nodes>
struct Element {
  std::array<Tag, nodes> node_tags;
  int text_line;
};

/// A line element in a physical group of curves.
struct GroupLine {
  Tag group;
  Element<2> element;
};

/// The number of no physical group.
constexpr Tag no_group = 0;

/// What the two versions of the format have in common once read.
struct Contents {
  std::map<Tag, std::string> curve_names;  // of physical groups
  std::vector<Node> nodes;
  std::vector<Element<3>> triangles;
  std::vector<GroupLine> lines;
};

enum ElementType : Tag { line = 1, triangle = 2, point = 15 };

void check_type(const GmshText& text, Tag type) {
  if (type == line || type == triangle || type == point) return;
  const std::string name = type == 3                ? " (quadrangles)"
                           : type == 8 || type == 9 ? " (second order)"
                           : type == 4              ? " (tetrahedra)"
                                                    : "";
  text.fail("elements of type " + std::to_string(type) + name +
            " are not supported; mesh with triangles of the first order");
}

template <std::size_t nodes>
Element<nodes> read_element(GmshText& text) {
  Element<nodes> element{};
  for (Tag& tag : element.node_tags) tag = text.integer("the number of a node");
  element.text_line = text.line();
  return element;
}

/// Reads the nodes of an element that lies in the given physical group.
void read_element_in(GmshText& text, Tag type, Tag group, Contents& contents) {
  if (type == point) read_element<1>(text);
  if (type == triangle) contents.triangles.push_back(read_element<3>(text));
  if (type != line) return;
  const Element<2> element = read_element<2>(text);
  if (group != no_group) contents.lines.push_back({group, element});
}

void read_coordinates(GmshText& text, Node& node) {
  const double x = text.number("a coordinate"), y = text.number("a coordinate");
  node.x = {x, y};
  node.z = text.number("a coordinate");
  node.text_line = text.line();
}

/// The sections of version 2.2, which lists nodes and elements one by one.
class Version2 {
 public:
  static constexpr bool has_entities = false;

  void read_entities(GmshText&) {}

  void read_nodes(GmshText& text, Contents& contents) {
    const std::size_t count = text.count("the number of nodes", 8);
    for (std::size_t i = 0; i < count; ++i) {
      contents.nodes.push_back({text.integer("the number of a node"), {0, 0}, 0, 0});
      read_coordinates(text, contents.nodes.back());
    }
  }

  void read_elements(GmshText& text, Contents& contents) {
    const std::size_t count = text.count("the number of elements", 6);
    for (std::size_t i = 0; i < count; ++i) {
      text.integer("the number of an element");
      const Tag type = text.integer("the type of an element");
      check_type(text, type);
      read_element_in(text, type, read_group(text), contents);
    }
  }

 private:
  /// The first tag is the physical group, its sign the orientation in it; the others do not matter here: the
  /// geometric entity, and the number of partitions with their numbers.
  static Tag read_group(GmshText& text) {
    const std::size_t tags = text.count("the number of tags", 2);
    Tag group = no_group;
    for (std::size_t i = 0; i < tags; ++i) {
      const Tag tag = text.integer("a tag");
      if (i == 0) group = std::abs(tag);
    }
    return group;
  }
};

/// The sections of version 4.1, which lists nodes and elements in blocks, one a geometric entity; the
/// entities have the physical groups.
class Version4 {
 public:
  static constexpr bool has_entities = true;

  void read_entities(GmshText& text) {
    std::array<std::size_t, 4> counts{};
    for (std::size_t& count : counts) count = text.count("the number of entities", 8);
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < counts[dimension]; ++i) read_entity(text, dimension);
  }

  void read_nodes(GmshText& text, Contents& contents) {
    const std::size_t blocks = read_header(text);
    for (std::size_t block = 0; block < blocks; ++block) {
      const Tag dimension = text.integer("the dimension of an entity");
      text.integer("the number of an entity");
      const bool parametric = text.integer("whether coordinates are parametric") != 0;
      const std::size_t count = text.count("the number of nodes", 8), first = contents.nodes.size();
      for (std::size_t i = 0; i < count; ++i)
        contents.nodes.push_back({text.integer("the number of a node"), {0, 0}, 0, 0});
      for (std::size_t i = 0; i < count; ++i) {
        read_coordinates(text, contents.nodes[first + i]);
        for (Tag k = 0; parametric && k < dimension; ++k) text.number("a parametric coordinate");
      }
    }
  }

  void read_elements(GmshText& text, Contents& contents) {
    const std::size_t blocks = read_header(text);
    for (std::size_t block = 0; block < blocks; ++block) {
      const Tag dimension = text.integer("the dimension of an entity");
      const Tag entity = text.integer("the number of an entity");
      const Tag type = text.integer("the type of the elements");
      const std::size_t count = text.count("the number of elements", 4);
      if (count > 0) check_type(text, type);
      const auto found = curve_groups_.find(entity);
      const bool has_group = dimension == 1 && found != curve_groups_.end();
      const Tag group = has_group ? found->second : no_group;
      for (std::size_t i = 0; i < count; ++i) {
        text.integer("the number of an element");
        read_element_in(text, type, group, contents);
      }
    }
  }

 private:
  /// The number of blocks; the totals behind it are not needed.
  static std::size_t read_header(GmshText& text) {
    const std::size_t blocks = text.count("the number of blocks", 8);
    for (const char* total : {"a total", "the smallest number", "the largest number"}) text.integer(total);
    return blocks;
  }

  void read_entity(GmshText& text, int dimension) {
    const Tag tag = text.integer("the number of an entity");
    for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) text.number("a coordinate");
    const std::size_t count = text.count("the number of physical groups", 2);
    for (std::size_t i = 0; i < count; ++i) {
      // The sign is the orientation of the entity in the group.
      const Tag group = std::abs(text.integer("the number of a physical group"));
      if (dimension != 1) continue;
      const auto [known, is_first] = curve_groups_.insert({tag, group});
      if (!is_first && known->second != group)
        text.fail("curve " + std::to_string(tag) + " is in the physical groups " +
                  std::to_string(known->second) + " and " + std::to_string(group) +
                  "; put it in one, for an edge of the boundary is in one part");
    }
    if (dimension == 0) return;
    const std::size_t bounds = text.count("the number of bounding entities", 2);
    for (std::size_t i = 0; i < bounds; ++i) text.integer("the number of a bounding entity");
  }

  std::map<Tag, Tag> curve_groups_;
};

void read_names(GmshText& text, Contents& contents) {
  const std::size_t count = text.count("the number of physical names", 6);
  for (std::size_t i = 0; i < count; ++i) {
    const Tag dimension = text.integer("the dimension of a physical group");
    const Tag tag = text.integer("the number of a physical group");
    const std::string name = text.quoted("the name of a physical group");
    if (dimension == 1) contents.curve_names[tag] = name;
  }
}

/// Reads the sections behind the format, in any order but that entities come before elements.
template <typename Version>
Contents read_sections(GmshText& text) {
  Version version;
  Contents contents;
  std::set<std::string_view> seen;
  while (!text.at_end()) {
    const std::string_view section = text.word("a section");
    if (section.size() < 2 || section[0] != '$')
      text.fail("expected a section such as $Nodes, not " + in_quotes(section));
    if (!seen.insert(section).second && (section == "$Nodes" || section == "$Elements"))
      text.fail("there is a second section " + std::string(section));
    const std::string end = "$End" + std::string(section.substr(1));
    if (section == "$PartitionedEntities")
      text.fail("a partitioned mesh is not supported; save it without partitions, or as version 2.2");
    if (section == "$PhysicalNames") {
      read_names(text, contents);
    } else if (section == "$Entities" && Version::has_entities) {
      version.read_entities(text);
    } else if (section == "$Nodes") {
      version.read_nodes(text, contents);
    } else if (section == "$Elements") {
      if (Version::has_entities && !seen.contains("$Entities"))
        text.fail("there is no section $Entities before $Elements, so that no line is in a physical group");
      version.read_elements(text, contents);
    } else {
      text.skip_past(end);
      continue;
    }
    text.expect(end);
  }
  for (const char* section : {"$Nodes", "$Elements"})
    if (!seen.contains(section)) text.fail("there is no section " + std::string(section));
  return contents;
}

Contents read_file(GmshText& text) {
  text.expect("$MeshFormat");
  const std::string_view version = text.word("the version of the format");
  if (version != "2.2" && version != "4.1")
    text.fail("version " + in_quotes(version) +
              " of the format is not supported; save as version 2.2 or 4.1 (Mesh.MshFileVersion)");
  if (text.integer("the type of the file") != 0)
    text.fail("a binary file is not supported; save as ASCII (Mesh.Binary = 0)");
  text.integer("the size of a number");
  text.expect("$EndMeshFormat");
  return version == "2.2" ? read_sections<Version2>(text) : read_sections<Version4>(text);
}

/// Numbers the nodes of triangles from 0 in the order of the file.
class Nodes {
 public:
  explicit Nodes(std::vector<Node> nodes) : nodes_(std::move(nodes)), number_(nodes_.size(), -1) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) by_tag_.push_back({nodes_[i].tag, i});
    std::ranges::sort(by_tag_);
    const auto twice = std::ranges::adjacent_find(by_tag_, {}, &std::pair<Tag, std::size_t>::first);
    if (twice != by_tag_.end())
      GmshText::fail_at(nodes_[std::next(twice)->second].text_line,
                        "there are two nodes " + std::to_string(twice->first));
  }

  template <std::size_t size>
  void use(const Element<size>& element) {
    for (const Tag tag : element.node_tags) number_[place(tag, element.text_line)] = 0;
  }

  /// The points of the nodes in use.
  std::vector<Point> take_numbers() {
    std::vector<Point> points;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (number_[i] < 0) continue;
      number_[i] = static_cast<int>(points.size());
      points.push_back(nodes_[i].x);
      used_.push_back(i);
    }
    check_height();
    return points;
  }

  /// The z of all nodes in use, but for rounding.
  double height() const { return nodes_[used_[0]].z; }

  template <std::size_t size>
  std::array<int, size> numbers(const Element<size>& element) const {
    std::array<int, size> numbers{};
    for (std::size_t i = 0; i < size; ++i) {
      numbers[i] = number_[place(element.node_tags[i], element.text_line)];
      if (numbers[i] < 0)
        GmshText::fail_at(
            element.text_line,
            "the line element's node " + std::to_string(element.node_tags[i]) + " belongs to no triangle");
    }
    return numbers;
  }

 private:
  std::size_t place(Tag tag, int text_line) const {
    const auto found = std::ranges::lower_bound(by_tag_, tag, {}, &std::pair<Tag, std::size_t>::first);
    if (found == by_tag_.end() || found->first != tag)
      GmshText::fail_at(text_line, "there is no node " + std::to_string(tag));
    return found->second;
  }

  /// How far the nodes in use lie apart along a coordinate.
  template <typename Coordinate>
  double extent(const Coordinate& coordinate) const {
    const auto [least, most] =
        std::ranges::minmax(used_, {}, [&](std::size_t i) { return coordinate(nodes_[i]); });
    return coordinate(nodes_[most]) - coordinate(nodes_[least]);
  }

  void check_height() const {
    const double x = extent([](const Node&node) { return node.x.x(); }),
                 y = extent([](const Node&node) { return node.x.y(); }),
                 z = extent([](const Node&node) { return node.z; });
    constexpr double rounding = 1e-9;
    if (z <= rounding * std::max(x, y)) return;
    const std::size_t other = *std::ranges::find_if(
        used_, [&](std::size_t i) { return std::abs(nodes_[i].z - height()) > rounding * std::max(x, y); });
    const bool lies_in_another_plane = std::min(x, y) <= rounding * z;
    GmshText::fail_at(
        nodes_[other].text_line,
        "the z of node " + std::to_string(nodes_[other].tag) + " is " + shortest(nodes_[other].z) +
            ", that of others " + shortest(height()) + "; " +
            (lies_in_another_plane
                 ? std::string("the mesh lies in a plane along z: turn it into the plane of x and y")
                 : std::string("the mesh must be plane, with the same z everywhere")));
  }

  std::vector<Node> nodes_;
  std::vector<std::pair<Tag, std::size_t>> by_tag_;
  std::vector<int> number_;  // of each node in use, else -1
  std::vector<std::size_t> used_;
};

}  // namespace

MeshData parse_gmsh(std::string_view text) {
  GmshText words(text);
  Contents contents = read_file(words);
  if (contents.triangles.empty()) words.fail("there are no triangles");
  if (contents.lines.empty())
    words.fail("no line is in a physical group; give every curve of the boundary one (Physical Curve)");
  if (contents.nodes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    words.fail("there are too many nodes");

  Nodes nodes(std::move(contents.nodes));
  for (const auto& element : contents.triangles) nodes.use(element);
  MeshData data;
  data.file = "/domain/msh";
  data.points = nodes.take_numbers();
  if (nodes.height() != 0)
    data.notes.push_back("the mesh of the file lies at z = " + shortest(nodes.height()) +
                         "; only x and y were read");
  for (const auto& element : contents.triangles) data.triangles.push_back(nodes.numbers(element));
  std::map<std::string, std::size_t> parts;
  for (const auto& [group, element] : contents.lines) {
    const auto name = contents.curve_names.find(group);
    const std::string part = name == contents.curve_names.end() ? std::to_string(group) : name->second;
    const auto [place, is_new] = parts.insert({part, data.boundary.size()});
    if (is_new && parts.size() > limits::parts)
      GmshText::fail_at(element.text_line, "the lines are in more than " + std::to_string(limits::parts) +
                                               " physical groups; put curves in the same");
    if (is_new) data.boundary.push_back({part, {}});
    data.boundary[place->second].second.push_back(nodes.numbers(element));
  }
  return data;
}

}  // namespace signorini::api
