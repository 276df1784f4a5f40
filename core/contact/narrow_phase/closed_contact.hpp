// closed_contact.hpp - energy that a contact that ended did not give back.
#pragma once

#include "core/contact/geometry/face.hpp"
#include "core/records/contact_records.hpp"

namespace cdem {

/// Energy that the springs of a contact that ended did not give back  [J]. Its two points moved by
/// `way` relative to each other in the step that ended it, seen in the frame of one step ago; half
/// the last force did the work. The normal spring gives back until it is free of stress, which is
/// `returned_n` of its penetration: what a contact that opened held is lost only in so far as its
/// dashpot kept it, but all of it is lost where a vertex slid off a face still under load.
struct DissipatedAtEnd {
  Real friction, dashpot;

  CDEM_HD DissipatedAtEnd(const ContactState& s, Real returned_n, const Frame<Real>& frame,
                          const Vec3<Real>& way)
      : friction(s.energy_s -
                 0.5 * (s.shear1 * dot(frame.t1, way) + s.shear2 * dot(frame.t2, way))),
        dashpot(s.energy_n -
                0.5 * s.force_n *
                    min_of(dot(frame.n, way), returned_n * max_of(s.penetration, 0.0))) {}
};

}  // namespace cdem
