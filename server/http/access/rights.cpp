#include "server/http/access/rights.h"

namespace parkade {

bool HasRight(const Caller& caller, Right right) {
  const bool is_admin = caller.role == Role::kAdmin;
  if (caller.has_link_only) return right == Right::kNone || right == Right::kSeeMaps;
  switch (right) {
    case Right::kNone:
    case Right::kSeeMaps:
    case Right::kSee: return true;
    case Right::kUpload:
    case Right::kOwnUpload: return is_admin || caller.role == Role::kUploader;
    case Right::kRunJob: return is_admin || caller.role != Role::kViewer;
    case Right::kReview: return is_admin || caller.role == Role::kReviewer;
    case Right::kPictures: return caller.may_see_pictures;
    case Right::kAdmin: break;
  }
  return is_admin;
}

bool NeedsToOwn(const Caller& caller, Right right) {
  return caller.role == Role::kUploader && (right == Right::kOwnUpload || right == Right::kRunJob);
}

const char* NeedOf(Right right) {
  switch (right) {
    case Right::kNone:
    case Right::kSeeMaps: return "nobody may";
    case Right::kSee: return "this takes a token: a share link is for maps only";
    case Right::kUpload:
    case Right::kOwnUpload: return "this takes the role uploader";
    case Right::kRunJob: return "this takes the role reviewer or uploader";
    case Right::kReview: return "this takes the role reviewer";
    case Right::kPictures: return "this takes a token made with the right to see camera pictures";
    case Right::kAdmin: break;
  }
  return "this takes the role admin";
}

}  // namespace parkade
