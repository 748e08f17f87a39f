#include "server/http/access/gate.h"

namespace parkade {

Caller Gate::Admit(const Route&, const httplib::Request& request, httplib::Response&) {
  Caller caller = CallerWithAllRights("local");
  caller.address = request.remote_addr;
  return caller;
}

}  // namespace parkade
