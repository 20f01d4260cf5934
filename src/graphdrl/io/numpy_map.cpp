#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMostRows = 20'000;  // a matrix of 400 million values

template <typename T>
double load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return static_cast<double>(value);
}

struct NumpyType {
  std::string_view name;
  double (*load)(const char* at);
};
constexpr NumpyType kTypes[] = {
    {"<f8", load<double>},        {"<f4", load<float>},         {"<i8", load<std::int64_t>},
    {"<i4", load<std::int32_t>},  {"<i2", load<std::int16_t>},  {"|i1", load<std::int8_t>},
    {"<u8", load<std::uint64_t>}, {"<u4", load<std::uint32_t>}, {"<u2", load<std::uint16_t>},
    {"|u1", load<std::uint8_t>},  {"|b1", load<std::uint8_t>}};

// An array of numbers as its file holds it [numpy.org, the NPY format].
class NumpyArray {
 public:
  NumpyArray(std::string_view bytes, const std::string& source) : source_(source) {
    std::size_t at = kMagic.size() + 2;
    if (bytes.size() < at + 4) fail("the file ends within the header");
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[i])); };
    const std::size_t length_bytes = bytes[kMagic.size()] == 1 ? 2 : 4;
    std::size_t length = 0;
    for (std::size_t i = 0; i < length_bytes; ++i) length |= byte(at + i) << (8 * i);
    at += length_bytes;
    if (length > bytes.size() - at) fail("the file ends within the header");
    const std::string_view header = bytes.substr(at, length);
    values_ = bytes.substr(at + length);
    read_type(header);
    if (value_of(header, "fortran_order") != "False") fail("an array in Fortran's order", "numpy.save of a C array");
    read_shape(header);
  }

  const std::vector<std::size_t>& shape() const { return shape_; }

  double operator[](std::size_t i) const { return load_(values_.data() + i * size_); }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& expected = {}, std::string_view got = {}) const {
    throw Error({.what = what, .expected = expected, .got = got.empty() ? "" : in_quotes(got), .where = source_});
  }

  // What stands behind a key of the header, a Python dictionary.
  std::string_view value_of(std::string_view header, std::string_view key) const {
    const std::size_t found = header.find(fmt::format("'{}'", key));
    if (found == std::string_view::npos) fail(fmt::format("no '{}' in the header", key));
    const std::size_t colon = header.find(':', found);
    if (colon == std::string_view::npos) fail(fmt::format("no value of '{}' in the header", key));
    const std::string_view rest = trimmed(header.substr(colon + 1));
    const std::size_t end = rest.starts_with('(') ? rest.find(')') : rest.find_first_of(",}");
    if (end == std::string_view::npos) fail(fmt::format("no value of '{}' in the header", key));
    return rest.substr(0, rest.starts_with('(') ? end + 1 : end);
  }

  void read_type(std::string_view header) {
    static_assert(std::endian::native == std::endian::little);
    const std::string_view type = value_of(header, "descr");
    const std::string_view name = type.size() == 5 ? type.substr(1, 3) : type;  // without its quotes
    const auto* const found = std::ranges::find(kTypes, name, &NumpyType::name);
    if (found == std::end(kTypes)) {
      fail("an array of another type", "numbers in little-endian order, as float64", type);
    }
    load_ = found->load;
    size_ = static_cast<std::size_t>(name[2] - '0');
  }

  void read_shape(std::string_view header) {
    const std::string_view text = value_of(header, "shape");
    if (!text.starts_with('(')) fail("bad shape", "a tuple", text);
    std::size_t count = 1;
    for (std::string_view rest = text.substr(1); !rest.empty() && rest.front() != ')';) {
      const std::size_t end = rest.find_first_of(",)");
      const auto number = parse_whole(trimmed(rest.substr(0, end)), 0, 1e9);
      if (!number) fail("bad shape", "", text);
      shape_.push_back(static_cast<std::size_t>(*number));
      rest = trimmed(rest.substr(rest[end] == ',' ? end + 1 : end));
    }
    const bool one = shape_.size() == 2 && shape_[0] == shape_[1];
    const bool two = shape_.size() == 3 && shape_[0] == 2 && shape_[1] == shape_[2];
    if ((!one && !two) || shape_.back() == 0 || shape_.back() > kMostRows) {
      fail("an array of another shape", fmt::format("(2, N, N) or (N, N), N up to {}", kMostRows), text);
    }
    for (const std::size_t size : shape_) count *= size;
    if (values_.size() < count * size_) fail("the file ends within the array", fmt::format("{} values", count));
  }

  const std::string& source_;
  std::string_view values_;
  double (*load_)(const char* at) = nullptr;  // a value
  std::size_t size_ = 0;                      // of a value, in bytes
  std::vector<std::size_t> shape_;
};

// The grid that has these edges and obstacles, with the edges of obstacles or without; nullopt where there is none.
std::optional<GridMap> as_grid(const Graph& graph, const std::vector<bool>& blocked) {
  const int side = static_cast<int>(std::lround(std::sqrt(graph.node_count())));
  if (side * side != graph.node_count() || graph.directed() || graph.weighted()) return std::nullopt;
  GridMap map{.rows = side, .cols = side, .blocked = blocked};
  const std::int64_t free_edges = Graph::grid(map).edge_count();
  if (graph.edge_count() != 2LL * side * (side - 1) && graph.edge_count() != free_edges) return std::nullopt;
  for (const Edge& edge : graph.edges()) {
    const bool beside = edge.b == edge.a + side || (edge.b == edge.a + 1 && edge.b % side != 0);
    if (!beside) return std::nullopt;
    const bool open = !blocked[edge.a] && !blocked[edge.b];
    if (!open && graph.edge_count() == free_edges) return std::nullopt;
  }
  return map;
}

}  // namespace

bool is_numpy(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

AnyMap parse_numpy_map(std::string_view bytes, const std::string& source) {
  const NumpyArray array(bytes, source);
  const std::size_t count = array.shape().back();
  std::vector<Edge> edges;
  bool symmetric = true;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const double cost = array[a * count + b];
      if (!(cost >= 0) || !std::isfinite(cost)) {
        throw Error({.what = fmt::format("bad value at [{}, {}] of the adjacency matrix", a, b),
                     .expected = "a number from 0 up",
                     .got = fmt::format("{}", cost),
                     .where = source});
      }
      symmetric = symmetric && cost == array[b * count + a];
      if (cost != 0 && a != b) edges.push_back({static_cast<NodeId>(a), static_cast<NodeId>(b), cost});
    }
  }
  std::vector<bool> blocked(count);
  for (std::size_t node = 0; node < count && array.shape().size() == 3; ++node) {
    blocked[node] = array[count * count + node * (count + 1)] != 0;
  }
  if (std::find(blocked.begin(), blocked.end(), false) == blocked.end()) {
    throw Error({.what = "the graph has no free node", .where = source});
  }
  Graph graph =
      Graph::from_edges(static_cast<NodeId>(count), edges, symmetric ? EdgeKind::kUndirected : EdgeKind::kDirected);
  if (auto grid = as_grid(graph, blocked)) return *std::move(grid);
  return GraphMap{.graph = std::move(graph), .blocked = std::move(blocked)};
}

}  // namespace graphdrl
