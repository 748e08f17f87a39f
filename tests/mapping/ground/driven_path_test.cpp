#include "mapping/ground/driven_path.h"

#include <gtest/gtest.h>

#include "tests/mapping/worlds/synthetic_drive.h"

namespace parkade {
namespace {

DrivenPath DriveStraight(const Rig& rig, double length) {
  return MakeDrivenPath(3, rig, DriveAlong(MakeLot(), {-15, 0, 0}, 0, {{length, 0}}, rig),
                        Rigid3{});
}

TEST(DrivenPath, ContactsLieUnderBothAxles) {
  const Rig rig = MakeTestRig();

  const std::vector<ContactPoint> contacts = FindContacts(DriveStraight(rig, 10), 0.5);

  EXPECT_NEAR(static_cast<double>(contacts.size()), 6 * 20, 12);
  for (const ContactPoint& contact : contacts) {
    EXPECT_NEAR(contact.point_in_site.z(), 0, 1e-9);
    EXPECT_LE(std::abs(contact.point_in_site.y()), 0.5 * rig.vehicle->track + 1e-9);
  }
  EXPECT_NEAR(contacts[1].point_in_site.x() - contacts[0].point_in_site.x(), rig.vehicle->wheelbase,
              1e-9);
  EXPECT_TRUE(contacts[1].is_front);
}

TEST(DrivenPath, WithoutACarThereIsOnePointBelowTheBody) {
  const Rig rig = MakeTestRig(/*has_vehicle=*/false);

  const std::vector<ContactPoint> contacts = FindContacts(DriveStraight(rig, 10), 0.5);

  EXPECT_NEAR(static_cast<double>(contacts.size()), 20, 2);
}

TEST(DrivenPath, AStandingCarLeavesOneSetOfContacts) {
  const Rig rig = MakeTestRig();
  const std::vector<PathPiece> standing(50);
  const DrivenPath path =
      MakeDrivenPath(0, rig, DriveAlong(MakeLot(), {0, 0, 0}, 0, standing, rig), Rigid3{});

  EXPECT_EQ(FindContacts(path, 0.2).size(), 6u);
}

TEST(DrivenPath, RemembersItsDriveAndCameras) {
  const Rig rig = MakeTestRig();

  const DrivenPath path = DriveStraight(rig, 1);

  EXPECT_EQ(path.drive, 3);
  ASSERT_EQ(path.cameras_in_body.size(), 4u);
  EXPECT_EQ(path.cameras_in_body[2], rig.cameras[2].body_from_camera.translation);
}

}  // namespace
}  // namespace parkade
