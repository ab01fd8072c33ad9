#include "tests/support/catmull_clark.h"

#include <algorithm>
#include <cmath>

namespace msbvh::procedural {

CatmullClark::CatmullClark(const SubdivisionMesh& cage) : corners_(cage.vertex_count, 0.0) {
  for (std::uint32_t v = 0; v < cage.vertex_count; ++v) points_.emplace_back(cage.positions[v]);
  std::size_t at = 0;
  for (std::uint32_t f = 0; f < cage.face_vertex_counts.size(); at += cage.face_vertex_counts[f++]) {
    Face face{{}, f, 0, {}};
    for (std::uint32_t i = 0; i < cage.face_vertex_counts[f]; ++i)
      face.vertices.push_back(static_cast<int>(cage.face_vertex_indices[at + i]));
    if (face.vertices.size() == 4) face.st = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    faces_.push_back(face);
  }
  for (std::size_t c = 0, i = 0, k = 0; c < cage.crease_lengths.size(); i += cage.crease_lengths[c++]) {
    for (std::uint32_t j = 0; j + 1 < cage.crease_lengths[c]; ++j, ++k) {
      creases_[edge(static_cast<int>(cage.crease_indices[i + j]),
                    static_cast<int>(cage.crease_indices[i + j + 1]))] =
          cage.crease_sharpnesses[cage.crease_sharpnesses.size() == cage.crease_lengths.size() ? c : k];
    }
  }
  for (std::size_t i = 0; i < cage.corner_indices.size(); ++i)
    corners_[cage.corner_indices[i]] = cage.corner_sharpnesses[i];
  const std::vector<Ring> all = rings();
  find_edges();
  for (std::size_t v = 0; v < points_.size(); ++v) {
    if (cage.boundary == BoundaryRule::kEdgeAndCorner && all[v].faces.size() == 1) corners_[v] = kInfinite;
  }
}

double CatmullClark::sharpness(int a, int b) const {
  const auto faces = edge_faces_.find(edge(a, b));
  if (faces != edge_faces_.end() && faces->second.size() == 1) return kInfinite;
  const auto found = creases_.find(edge(a, b));
  return found == creases_.end() ? 0.0 : found->second;
}

std::vector<CatmullClark::Ring> CatmullClark::rings() const {
  std::vector<Ring> out(points_.size());
  for (int f = 0; f < static_cast<int>(faces_.size()); ++f) {
    const auto& v = faces_[f].vertices;
    for (std::size_t i = 0; i < v.size(); ++i) {
      out[v[i]].faces.emplace_back(f, static_cast<int>(i));
      for (const int w : {v[(i + 1) % v.size()], v[(i + v.size() - 1) % v.size()]}) {
        if (std::find(out[v[i]].edges.begin(), out[v[i]].edges.end(), w) == out[v[i]].edges.end())
          out[v[i]].edges.push_back(w);
      }
    }
  }
  return out;
}

Vec3d CatmullClark::centre(const Face& f) const {
  Vec3d sum;
  for (const int v : f.vertices) sum += points_[v];
  return sum * (1.0 / static_cast<double>(f.vertices.size()));
}

int CatmullClark::rule(int v, const Ring& ring, bool child) const {
  const auto value = [&](double s) { return child ? less_sharp(s) : s; };
  if (value(corners_[v]) > 0.0) return 3;
  const auto sharp = std::count_if(ring.edges.begin(), ring.edges.end(),
                                   [&](int w) { return value(sharpness(v, w)) > 0.0; });
  return sharp < 2 ? 0 : (sharp == 2 ? 2 : 3);
}

Vec3d CatmullClark::vertex_by_rule(int v, const Ring& ring, int rule, bool child) const {
  if (rule == 3) return points_[v];
  if (rule == 2) {
    Vec3d sum;
    for (const int w : ring.edges) {
      const double s = sharpness(v, w);
      if ((child ? less_sharp(s) : s) > 0.0) sum += points_[w];
    }
    return points_[v] * 0.75 + sum * 0.125;
  }
  const double n = static_cast<double>(ring.edges.size());
  Vec3d sum;
  for (const int w : ring.edges) sum += points_[w];
  for (const auto& [f, corner] : ring.faces) sum += centre(faces_[f]);
  return points_[v] * ((n - 2.0) / n) + sum * (1.0 / (n * n));
}

// The mean of what ends here and now: sharpnesses of at most 1.
double CatmullClark::fraction(int v, const Ring& ring) const {
  double sum = 0.0;
  int count = 0;
  const auto add = [&](double s) {
    if (s <= 0.0 || s > 1.0) return;
    sum += s;
    ++count;
  };
  add(corners_[v]);
  for (const int w : ring.edges) add(sharpness(v, w));
  return count == 0 ? 0.0 : sum / count;
}

Vec3d CatmullClark::vertex_point(int v, const Ring& ring) const {
  const int now = rule(v, ring, false), later = rule(v, ring, true);
  const Vec3d sharp = vertex_by_rule(v, ring, now, false);
  if (now == later) return sharp;
  const double f = fraction(v, ring);
  return sharp * f + vertex_by_rule(v, ring, later, true) * (1.0 - f);
}

Vec3d CatmullClark::edge_point(const Edge& e) const {
  const Vec3d middle = (points_[e.first] + points_[e.second]) * 0.5;
  const double s = std::min(1.0, sharpness(e.first, e.second));
  if (s >= 1.0) return middle;
  const auto& faces = edge_faces_.at(e);
  const Vec3d smooth = middle * 0.5 + (centre(faces_[faces[0]]) + centre(faces_[faces[1]])) * 0.25;
  return middle * s + smooth * (1.0 - s);
}

void CatmullClark::refine() {
  const std::vector<Ring> ring = rings();
  std::vector<Vec3d> points;
  std::vector<double> corners;
  for (std::size_t v = 0; v < points_.size(); ++v) {
    points.push_back(vertex_point(static_cast<int>(v), ring[v]));
    corners.push_back(less_sharp(corners_[v]));
  }
  std::map<Edge, int> middle;
  std::map<Edge, double> creases;
  for (const auto& [e, faces] : edge_faces_) {
    middle[e] = static_cast<int>(points.size());
    const double s = less_sharp(sharpness(e.first, e.second));
    if (s > 0.0) creases[edge(e.first, middle[e])] = creases[edge(e.second, middle[e])] = s;
    points.push_back(edge_point(e));
  }
  std::vector<Face> faces;
  for (const Face& f : faces_) {
    const int centre_id = static_cast<int>(points.size());
    points.push_back(centre(f));
    for (int i = 0; i < static_cast<int>(f.vertices.size()); ++i)
      faces.push_back(child(f, i, centre_id, middle));
  }
  corners.resize(points.size(), 0.0);
  points_ = std::move(points);
  corners_ = std::move(corners);
  creases_ = std::move(creases);
  faces_ = std::move(faces);
  find_edges();
}

CatmullClark::Face CatmullClark::child(const Face& f, int i, int centre, const std::map<Edge, int>& middle) {
  const int n = static_cast<int>(f.vertices.size());
  const auto vertex = [&](int k) { return f.vertices[(k + n) % n]; };
  Face out{{vertex(i), middle.at(edge(vertex(i), vertex(i + 1))), centre,
            middle.at(edge(vertex(i - 1), vertex(i)))},
           f.base,
           f.square,
           {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  if (f.st.empty()) {  // a cage's face that is no quad: its children are squares of their own
    out.square = static_cast<std::uint32_t>(i);
    return out;
  }
  const auto mean = [&](int k) {
    const auto &a = f.st[i], &b = f.st[(k + n) % n];
    return std::array{0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
  };
  out.st = {f.st[i], mean(i + 1), mean(i + 2), mean(i - 1)};
  return out;
}

void CatmullClark::find_edges() {
  edge_faces_.clear();
  for (int f = 0; f < static_cast<int>(faces_.size()); ++f) {
    const auto& v = faces_[f].vertices;
    for (std::size_t i = 0; i < v.size(); ++i) edge_faces_[edge(v[i], v[(i + 1) % v.size()])].push_back(f);
  }
}

Vec3d CatmullClark::limit(int v, const Ring& ring) const {
  const int kind = rule(v, ring, false);
  if (kind == 3) return points_[v];
  Vec3d edges, corners;
  if (kind == 2) {
    for (const int w : ring.edges) {
      if (sharpness(v, w) > 0.0) edges += points_[w];
    }
    return (points_[v] * 4.0 + edges) * (1.0 / 6.0);
  }
  const double n = static_cast<double>(ring.edges.size());
  for (const int w : ring.edges) edges += points_[w];
  for (const auto& [f, corner] : ring.faces) corners += points_[faces_[f].vertices[(corner + 2) % 4]];
  return (points_[v] * (n * n) + edges * 4.0 + corners) * (1.0 / (n * (n + 5.0)));
}

std::map<CatmullClark::Place, Vec3d> CatmullClark::limits(int level) const {
  const std::vector<Ring> ring = rings();
  const double scale = std::ldexp(1.0, level);
  std::map<Place, Vec3d> out;
  for (const Face& f : faces_) {
    for (std::size_t i = 0; i < 4; ++i) {
      const Place at{f.base, f.square, static_cast<int>(std::lround(f.st[i][0] * scale)),
                     static_cast<int>(std::lround(f.st[i][1] * scale))};
      out.emplace(at, limit(f.vertices[i], ring[f.vertices[i]]));
    }
  }
  return out;
}

}  // namespace msbvh::procedural
