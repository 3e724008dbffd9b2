// Our sensor model as an MRPT metric map, by which MRPT's particle filters weigh their particles. Only the
// localiser and its benchmark include this header, because it exposes MRPT.
#ifndef DOCENT_ROBOT_ADAPTERS_LOCALIZATION_DISTANCE_MAP_H_
#define DOCENT_ROBOT_ADAPTERS_LOCALIZATION_DISTANCE_MAP_H_

#include <mrpt/maps/CMetricMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>

#include <memory>
#include <optional>
#include <string>

#include "robot_adapters/localization/sensor_model.h"

namespace docent::robot {

// Conversion of scans to MRPT and back. The observation's time stamp is left unset.
mrpt::obs::CObservation2DRangeScan::Ptr ToMrpt(const maps::LaserScan& scan);
maps::LaserScan FromMrpt(const mrpt::obs::CObservation2DRangeScan& observation);

// Weighs 2D range scans only, no other observations. Read-only: it supports no insertion. One thread at a
// time (it caches the beams of the last scan).
class DistanceMap : public mrpt::maps::CMetricMap {
  DEFINE_SERIALIZABLE(DistanceMap, docent::robot)

 public:
  DistanceMap() = default;
  DistanceMap(std::shared_ptr<const SensorModel> model, int max_beams)
      : model_(std::move(model)), max_beams_(max_beams) {}

  // Converts the beams of `observation` once; later likelihoods of this object need no conversion.
  void Prepare(const mrpt::obs::CObservation2DRangeScan& observation);

  bool isEmpty() const override { return model_ == nullptr; }
  void saveMetricMapRepresentationToFile(const std::string& file_name_prefix) const override;
  void getVisualizationInto(mrpt::opengl::CSetOfObjects& objects) const override;
  std::string asString() const override;

 private:
  void internal_clear() override;
  bool internal_insertObservation(const mrpt::obs::CObservation& observation,
                                  const std::optional<const mrpt::poses::CPose3D>& robot_pose) override;
  double internal_computeObservationLikelihood(const mrpt::obs::CObservation& observation,
                                               const mrpt::poses::CPose3D& robot_in_hall) const override;
  bool internal_canComputeObservationLikelihood(const mrpt::obs::CObservation& observation) const override;

  std::shared_ptr<const SensorModel> model_;
  int max_beams_ = 180;
  const mrpt::obs::CObservation* prepared_ = nullptr;
  BeamEnds prepared_ends_;
};

}  // namespace docent::robot

#endif  // DOCENT_ROBOT_ADAPTERS_LOCALIZATION_DISTANCE_MAP_H_
