// What a frame says about a posed model.
#pragma once

#include <cstddef>

#include "recognition/frame/frame.h"
#include "recognition/pairs/pair_model.h"

namespace graspdb::recognition {

struct ImageEvidenceParameters {
  // Surfaces nearer than this are the same, m; at least noise_factor deviations of a measurement.
  float tolerance_m = 0.006F;
  float noise_factor = 2.5F;
  // Cosine between normals of one surface.
  float min_normal_cosine = 0.6F;
  // Beside the outline, where the object has ended: this far, m, and at least so many pixels.
  float beside_m = 0.006F;
  float beside_px = 2.5F;
  // Cosine between normals on both sides of a crease, at most.
  float max_crease_cosine = 0.85F;
};

// Surfaces at depth `z` (m) that are nearer to each other are the same, m.
float ToleranceAt(const Frame& frame, float z, const ImageEvidenceParameters& parameters);

// Shares of the surface that the camera would see were nothing in front of it.
struct SurfaceEvidence {
  float seen = 0;          // measured there
  float contradicted = 0;  // the camera looked through, or another surface is there
  float tilted = 0;        // of the contradicted: a surface of another direction is there
  float table = 0;         // only the table is there
  float hidden = 0;        // something nearer hides it
  float covered = 0;       // of the hidden: by something close in front
  float unmeasured = 0;    // or outside of the region
  float rms_m = 0;         // of what was seen, across the surface
  float bend = 0;          // of what was seen, the mean of 1 - the cosine between the normals
  float seen_area_m2 = 0;
  std::size_t seen_count = 0;

  // For the order of hypotheses, 0 to 1.
  float Score() const;
};

// Along the outline, where nothing hides it: does the scene end as well, by a depth step, a concave
// crease or the table?
struct OutlineEvidence {
  float smooth = 0;       // share where the scene goes on as it is
  float unknown = 1;      // share of all that is hidden, not measured or not there
  std::size_t count = 0;  // points that are not unknown
};

// Looks up at most `max_points` of the visible points, with so many times the tolerance.
// `sensor_object`: T_sensor_object.
SurfaceEvidence LookAtSurface(const Frame& frame, const ImageModel& model,
                              const ModelAspect& aspect, const Eigen::Isometry3f& sensor_object,
                              std::size_t max_points, float tolerance_factor,
                              const ImageEvidenceParameters& parameters);

// `sensor_object`: T_sensor_object.
OutlineEvidence LookAtOutline(const Frame& frame, const ModelAspect& aspect,
                              const Eigen::Isometry3f& sensor_object,
                              const ImageEvidenceParameters& parameters);

// The aspect that the sensor sees of an object at this pose.
const ModelAspect& AspectAt(const PairModel& model, const Eigen::Isometry3f& sensor_object);

// Height of the object's lowest point, of some hundred, over the table, m; negative below it. Both
// in the sensor frame.
float ClearanceOver(const Plane& table, const ImageModel& model,
                    const Eigen::Isometry3f& sensor_object);

}  // namespace graspdb::recognition
