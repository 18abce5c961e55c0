#pragma once

#include <CGAL/Delaunay_mesher_2.h>

namespace signorini {

/// Whether a constrained edge has no vertex opposite to it within its diametral circle, of those in the
/// domain. CGAL's own predicate (Is_locally_conforming_Gabriel) looks at both sides of the edge: beside a
/// narrow slot it would have the domain as fine as the slot is narrow. Circumcentres of the domain's
/// triangles lie in the domain as long as no vertex that its edges see encroaches upon them (Shewchuk 2002,
/// lemma 3).
template <typename Triangulation>
struct IsGabrielInDomain : CGAL::Mesh_2::Is_locally_conforming_Gabriel<Triangulation> {
  using Base = CGAL::Mesh_2::Is_locally_conforming_Gabriel<Triangulation>;
  using Face = typename Triangulation::Face_handle;
  using Vertex = typename Triangulation::Vertex_handle;
  using Base::operator();  // of a point that is to come, and of the domain

  bool operator()(const Triangulation& triangulation, const Face& face, int edge) const {
    return is_clear(triangulation, face, edge) &&
           is_clear(triangulation, face->neighbor(edge), triangulation.tds().mirror_index(face, edge));
  }

  bool operator()(const Triangulation& triangulation, const Vertex& from, const Vertex& to) const {
    Face face;
    int edge = 0;
    triangulation.is_edge(from, to, face, edge);
    return (*this)(triangulation, face, edge);
  }

 private:
  bool is_clear(const Triangulation& triangulation, const Face& face, int edge) const {
    return !face->is_in_domain() || Base::operator()(triangulation, face, edge, face->vertex(edge)->point());
  }
};

/// CGAL's cutting of edges, with the triangles at a new point marked before the edges around it are looked
/// at.
template <typename Triangulation>
class DomainEdges
    : public CGAL::Mesh_2::Refine_edges_base_with_clusters<Triangulation, IsGabrielInDomain<Triangulation>> {
  using Base = CGAL::Mesh_2::Refine_edges_base_with_clusters<Triangulation, IsGabrielInDomain<Triangulation>>;
  using Vertex = typename Triangulation::Vertex_handle;

 public:
  using Base::Base;

  void after_insertion_impl(const Vertex& cut) {
    mark_around(cut);
    Base::after_insertion_impl(cut);
  }

 private:
  /// On each side of the edge that was cut as its triangle was; CGAL's visitor does so after the edges.
  void mark_around(Vertex cut) {
    typename Triangulation::Face_handle right_of_edge;
    int opposite = 0;
    this->tr.is_edge(this->visitor_va, cut, right_of_edge, opposite);
    bool mark = this->visitor_mark_at_right;
    const auto first = this->tr.incident_faces(cut, right_of_edge);
    auto face = first;
    do {
      if (face->vertex(Triangulation::ccw(face->index(cut))) == this->visitor_vb)
        mark = this->visitor_mark_at_left;
      if (!this->tr.is_infinite(face)) face->set_in_domain(mark);
    } while (++face != first);
  }
};

/// Refines the triangles of a domain, which are marked as such, until its criteria are met: CGAL's
/// Delaunay_mesher_2, but for the edges of the domain, to which only what lies in it matters.
template <typename Triangulation, typename Criteria>
class DomainMesher {
 public:
  DomainMesher(Triangulation& triangulation, const Criteria& criteria)
      : criteria_(criteria),
        clusters_(triangulation),
        edges_(triangulation, clusters_, none_before_),
        faces_(triangulation, criteria_, edges_),
        visitor_(faces_, edges_, no_visitor_) {
    clusters_.create_clusters();
    edges_.scan_triangulation();
    faces_.scan_triangulation();
  }

  /// Tries to refine one edge or triangle; false if none is left.
  bool try_one_step() { return faces_.one_step(visitor_); }

 private:
  using Edges = CGAL::Mesh_2::Refine_edges_with_clusters<Triangulation, IsGabrielInDomain<Triangulation>,
                                                         DomainEdges<Triangulation>>;
  using Faces = CGAL::Mesh_2::Refine_faces<Triangulation, Criteria, Edges>;

  Criteria criteria_;
  CGAL::Null_mesher_level none_before_;
  CGAL::Null_mesh_visitor no_visitor_;
  CGAL::Mesh_2::Clusters<Triangulation> clusters_;
  Edges edges_;
  Faces faces_;
  CGAL::Mesh_2::Refine_edges_visitor_from_faces<Faces> visitor_;
};

}  // namespace signorini
