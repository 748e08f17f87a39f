#pragma once

namespace parkade::simulator {

/// How a tracker errs and loses: tuned so that tracks with these numbers are like
/// those of slam/tracking/feature_tracker on rendered images (track_model_test compares).
///
/// "Change" of a track's look is what its patch has gone through: the change of
/// the logarithm of its area in the image plus the angle [rad] by which its
/// surface is seen from elsewhere.
struct TrackModel {
  double white =
      0.02;  ///< [px] per axis, new in every image, at rest; grows with a track's own roughness
  double blur = 0.02;   ///< [px] of noise, per root of a pixel of flow
  double drift = 0.05;  ///< [px] per axis that the error walks per root of change
  double slide = 9;     ///< [px] along the flow per unit of growth or shrinking, ahead and behind
  double slide_limit = 0.1;  ///< of growth per image: beyond it a track slides no faster there
  double slide_age =
      15;  ///< [images] until which it slides less than half as fast: its first look fades
  double slide_beside = 0.2;  ///< [px] per unit of growth, where the camera looks across its way
  double slide_across = 0.4;  ///< of all these, across the flow
  double roughness = 0.4;     ///< tracks differ: standard deviation of the logarithm of their noise
  double edges =
      1.0;  ///< share of tracks near an outline that hold on to what is behind it as well
  double loss = 0.001;  ///< chance per image to be lost without a reason
  double loss_per_growth =
      0.3;  ///< chance per image and unit of growth of the patch since the last
  double loss_per_flow = 0.006;  ///< chance per image for a flow of 10 px; grows with its square
  double loss_new = 0.11;  ///< the same in a track's second image, into which nothing predicts it
  double frailty = 0.8;  ///< standard deviation of the logarithm of a track's own chance to be lost
  double jump = 0.0005;  ///< chance per image of a moving car to take something alike for the
                         ///< point: 3 to 10 px away
  double texture = 0.25;  ///< share of plain places that have a corner; outlines always have one
  double sky = 0.01;      ///< share of places in the sky that have one
  double shadow = 0.9;    ///< share of corners at the edge of the own car's shadow that go with it
  double crossing =
      0.5;  ///< chance that a point in two cameras' view is found in both, looking alike
  double crossing_angle =
      0.7;  ///< [rad] between the two lines of sight by which that chance falls to a third
  double crossing_noise = 0.3;  ///< [px] per axis, of such a match

  template <typename Visitor>
  void VisitFields(Visitor&& visit) {
    visit("white", white);
    visit("blur", blur);
    visit("drift", drift);
    visit("slide", slide);
    visit("slide_limit", slide_limit);
    visit("slide_age", slide_age);
    visit("slide_beside", slide_beside);
    visit("slide_across", slide_across);
    visit("roughness", roughness);
    visit("edges", edges);
    visit("loss", loss);
    visit("loss_per_growth", loss_per_growth);
    visit("loss_per_flow", loss_per_flow);
    visit("loss_new", loss_new);
    visit("frailty", frailty);
    visit("jump", jump);
    visit("texture", texture);
    visit("sky", sky);
    visit("shadow", shadow);
    visit("crossing", crossing);
    visit("crossing_angle", crossing_angle);
    visit("crossing_noise", crossing_noise);
  }
  void Validate() const;  ///< throws Error{kUsage}
};

}  // namespace parkade::simulator
